"""What ride figures are read off: the acceleration at a point of the hull, and the stretch of a run that counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.config.config import Config, FlatRoad, ProfileRoad, RandomRoad, SimpleRoad, SineRoad, SumRoad
from model.road.road import build_road, profile_of
from model.simulation.trajectory import Motion

SETTLING = 2.0  # s after the last wheel has come to the full waves, in which the start dies away
SHORTEST = 2.5  # s of waves or of a measured profile from which figures can be told
SETTLED = 1e-3  # of the hull's motion in its worst second: less to come is as good as rest
BEYOND = 0.5  # of the time in which the hull settles: so much longer a run must go on for that time to be known…
RESTING = 0.5  # … and so many seconds at least

WHOLE = "peaks of loads and acceleration, pitch, travel and time in the air are those of the whole run"

Point = tuple[float, float]  # forward and up from the hull's centre of mass, in the hull's frame, m
CENTRE_OF_MASS: Point = (0.0, 0.0)


@dataclass(frozen=True)
class Window:
    """The stretch of a run that its figures are taken from, all but those that WHOLE names."""

    start: float  # s
    end: float  # s
    why: str  # "from 4.3 s on, when the start has died away"
    shortfall: str = ""  # a sentence that says what the run is too short for; empty where it is long enough
    goes_on: bool = True  # whether it would be longer in a longer run
    reached: bool = True  # whether any wheel comes to what is uneven

    @property
    def length(self) -> float:
        """s."""
        return self.end - self.start

    def samples(self, t: np.ndarray) -> slice:
        """Those of a run with samples at t (N,), s, that belong to it: one at least."""
        return slice(int(np.searchsorted(t, self.start)), int(np.searchsorted(t, self.end, side="right")))


def same_window(*windows: Window) -> bool:
    """Whether what grows with time may be compared: all as long as each other, or none that would go on."""
    lengths = [taken.length for taken in windows]
    return not any(taken.goes_on for taken in windows) or max(lengths) - min(lengths) < 1e-9


def seat(config: Config) -> Point:
    """Where the driver sits."""
    return config.vehicle.seat.x, config.vehicle.seat.y


def point_acceleration(motion: Motion, point: Point = CENTRE_OF_MASS) -> np.ndarray:
    """(N, 2) m/s²: acceleration of a point fixed to the hull, forward and up along the world's axes.

    The point goes with the hull as a rigid body: a + θ̈ × r − θ̇² r, r the way to it from the centre of mass.
    """
    hull = motion.system.chassis
    pitch = motion.q[:, hull, 2]
    along, up, growth = np.ascontiguousarray(motion.a[:, hull].T)
    square = motion.v[:, hull, 2] ** 2
    x, y = point
    cos, sin = np.cos(pitch), np.sin(pitch)
    r_x, r_y = cos * x - sin * y, sin * x + cos * y
    return np.array([along - growth * r_y - square * r_x, up + growth * r_x - square * r_y]).T


def window(motion: Motion) -> Window:
    """The stretch of a run of at least one sample that its figures are taken from.

    Waves (sine or random, in a sum too) go on: from when the last road wheel is on the full waves and the start has
    died away to the end of the run; of a sine the last whole waves, as a part of one would bias means. An obstacle or a
    measured profile comes to an end: from the first wheel's contact until the last wheel is off it and the hull has
    settled, so that a longer run has the same figures. A level road, and a stretch of a drive, count as a whole.
    """
    start, end = float(motion.t[0]), float(motion.t[-1])
    if start > 0:
        return Window(start, end, "over this stretch of the drive")
    road = motion.config.road
    parts: list[SimpleRoad] = list(road.parts) if isinstance(road, SumRoad) else [road]
    if any(isinstance(part, SineRoad | RandomRoad) for part in parts):
        return _on_waves(motion, parts)
    uneven = build_road(motion.config).uneven
    if uneven is None:
        return Window(start, end, "over the whole run")
    measured = any(isinstance(part, ProfileRoad) for part in parts)
    several = sum(not isinstance(part, FlatRoad) for part in parts) > 1
    return _over(motion, uneven, "profile" if measured else "obstacles" if several else "obstacle", measured)


def _on_waves(motion: Motion, parts: list[SimpleRoad]) -> Window:
    """In a run that is too short at least half of it."""
    wheels, end = motion.config.vehicle.road_wheels, float(motion.t[-1])
    waves = [part for part in parts if isinstance(part, SineRoad | RandomRoad)]
    full = max(profile_of(wave, wheels.x[0], wheels.radius, 0.0).pieces[-1].nodes[0] for wave in waves)
    steady = float((full - wheels.x[-1]) / motion.system.v_ref + SETTLING)
    if end - steady >= SHORTEST:
        over = ""
        if len(waves) == 1 and isinstance(waves[0], SineRoad):
            period = waves[0].wavelength / float(motion.system.v_ref)
            count = int((end - steady) / period)
            if count > 0:
                steady = end - count * period
                over = "over the last wave, " if count == 1 else f"over the last {count} waves, "
        return Window(steady, end, f"{over}from {steady:.1f} s on, when the start has died away")
    start = min(steady, end / 2)
    shortfall = f"The start has died away only after {steady:.1f} s: let the run last {steady + SHORTEST:.0f} s or more"
    return Window(start, end, f"from {start:.1f} s on", shortfall)


def _over(motion: Motion, uneven: tuple[float, float], name: str, measured: bool) -> Window:
    """Over something that is uneven between two x, m, and has a name; measured: a run need not come to its end."""
    t, system = motion.t, motion.system
    last = float(t[-1])
    wheels = motion.q[:, system.wheel, 0]
    come = wheels.max(axis=1) + system.r >= uneven[0]
    if not come.any():
        shortfall = (
            f"The run ends before a wheel comes to the {name}: it begins at x = {uneven[0]:.6g} m, the wheels came to "
            f"{wheels.max():.4g} m"
        )
        return Window(float(t[0]), last, "over the whole run", shortfall, reached=False)
    first = int(come.argmax())
    start = float(t[first])
    began = f"from {start:.2f} s, when the first wheel comes to the {name},"
    off = len(t) - int((wheels.min(axis=1) - system.r <= uneven[1])[::-1].argmax())
    if off == len(t):
        shortfall = "" if measured and last - start >= SHORTEST else f"The run ends while wheels are on the {name}"
        return Window(start, last, f"{began} to the end of the run", shortfall)
    settled = max(off, _settled(motion, first))
    end = float(t[settled])
    known = last - end >= max(BEYOND * (end - float(t[off])), RESTING)
    shortfall = "" if known else f"The run ends before the hull has settled behind the {name}"
    words = f"{began} to {end:.2f} s, when the last is off it and the hull has settled"
    return Window(start, end, words, shortfall, goes_on=not known)


def _settled(motion: Motion, first: int) -> int:
    """The sample at which the hull has settled: what is still to come of its rising, falling and pitching, by its
    kinetic energy summed over time, is less than SETTLED of that in the worst second since the sample `first`.

    A sum over time, other than the largest value in it, changes little where the run changes little.
    """
    system = motion.system
    v = motion.v[first:, system.chassis, 1:]
    inertia = np.array([system.mass[system.chassis], system.inertia[system.chassis]])
    sums = np.concatenate([[0.0], np.cumsum(v**2 @ inertia)])
    second = min(round(motion.config.simulation.output_rate), len(v))
    worst = (sums[second:] - sums[:-second]).max()
    return first + int((sums[-1] - sums[1:] <= SETTLED * worst).argmax())
