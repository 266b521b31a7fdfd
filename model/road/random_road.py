"""Random roads of the classes of ISO 8608, the same everywhere for the same seed.

The one-sided density of the heights is G_d(n) = G_d(n_0) (n/n_0)^−2 with n_0 = 0.1 cycles/m and G_d(n_0) = 16e-6 m³ for
class A, four times as much for each further class (the standard's geometric means). A road of length ℓ is the sum of
cosines at n_k = k/ℓ within the band, of amplitude √(2 G_d(n_k)/ℓ) and random phase, so that it repeats itself smoothly.

The band begins at the longest wave that is asked for. It ends where a wheel feels nothing any more: at waves as short
as its radius. It touches the ground over about half of that, more than one point, and would average shorter ones. With
another longest wave, or under other wheels, a road gains or loses waves at the ends of its band; all others stay.

Phases come from the bit stream of PCG64, which NumPy keeps as it is: the k-th number of 64 bits, its upper 53 bits
divided by 2^53, is the phase of the k-th cosine in turns, whether those before it are in the band or not. Only
rounding depends on the machine.
"""

from __future__ import annotations

import numpy as np

from model.config.config import RandomRoad
from model.road.profile import Derivatives, Profile, rising, spline, weighted

CLASSES = "ABCDEFGH"
CLASS_A = 16e-6  # G_d(n_0), m³
N_0 = 0.1  # cycles/m
HIGHEST = 10.0  # cycles/m, the end of the band
NODES_PER_WAVE = 5  # of the shortest; quintics between them miss it by 1e-4 of its amplitude
PLACE = 5.0  # m from the start to where the first repetition begins
RUN_IN = 0.25  # of its longest wave, over which the road grows to its full height


def density(roughness_class: str, n: np.ndarray) -> np.ndarray:
    """G_d at spatial frequencies n in cycles/m, m³."""
    return CLASS_A * 4.0 ** CLASSES.index(roughness_class) * (n / N_0) ** -2


def highest(radius: float) -> float:
    """Where the band ends for wheels of a radius, cycles/m."""
    return min(HIGHEST, 1 / radius)


def longest(road: RandomRoad) -> float:
    """The longest wave that there can be on a road, m."""
    return min(road.longest_wave, road.length)


def heights(road: RandomRoad, radius: float) -> Derivatives:
    """h, h′, h″ (K,) of one repetition at x = 0, ℓ/K, 2ℓ/K, …, for wheels of a radius."""
    length = road.length
    waves = int(np.floor(highest(radius) * length + 1e-9))
    count = 2 * int(np.ceil(waves * NODES_PER_WAVE / 2))
    k = np.arange(1, waves + 1)
    turns = (np.random.PCG64(road.seed).random_raw(len(k)) >> np.uint64(11)) / 2.0**53
    n = k / length
    within = n >= 1 / road.longest_wave - 1e-12
    amplitude = np.where(within, np.sqrt(2 * density(road.roughness_class, n) / length), 0.0)
    line = np.zeros(count // 2 + 1, dtype=complex)
    line[k] = count / 2 * amplitude * np.exp(2j * np.pi * turns)
    wave = 2j * np.pi * np.arange(len(line)) / length
    h, h1, h2 = (np.fft.irfft(line * wave**order, count) for order in range(3))
    return h, h1, h2


def random_profile(road: RandomRoad, start: float, radius: float) -> Profile:
    """The road from `start` on, m: it runs in over some RUN_IN, and from there on repeats every `length`."""
    wave = heights(road, radius)
    count = len(wave[0])
    nodes = np.linspace(0.0, road.length, count + 1)
    # A longer run-in ends behind PLACE, so that no bump moves
    behind = round((RUN_IN * longest(road) - PLACE) * count / road.length)
    once = [np.append(values, values[0]) for values in (np.roll(part, -behind) for part in wave)]
    first = int(np.searchsorted(nodes, road.length - PLACE)) - behind
    run_in = road.length - nodes[first]

    # What would come before it, times a weight that rises from 0 to 1
    u = (nodes[first:] - nodes[first]) / run_in
    h, h1, h2 = (values[first:] for values in once)
    risen = weighted(rising(u, run_in), (h, h1, h2))
    steady = start + run_in
    return Profile([spline(start + run_in * u, *risen), spline(steady + nodes, *once)], road.length)
