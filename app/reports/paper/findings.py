"""The paper's statements, one by one: what our runs say to each, in sentences chosen by their numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

import numpy as np

from app.reports.paper.words import HARDLY, change_words, length_words, list_words, share_words
from model.config.config import SineRoad
from model.config.parameters import WHEEL_COUNT, number_text
from model.dynamics.ground import depth
from model.paper.study import PRELOAD, TIGHT, Figures, PaperStudy, reach

Verdict = Literal["holds", "holds within limits", "does not hold here", "cannot be compared"]

LITTLE = 0.05  # share of the load that counts as almost none
NOTABLE = 0.05  # of the fundamental's amplitude: a harmonic that is worth a word
NEAR = 0.05  # Hz by which a peak may miss the paper's 0.6 Hz, which is given to one digit
PAPER_PEAK = 0.6  # Hz, section 5
QUITE_LOWER = 0.5  # part of the road springs' stiffness that is quite lower


class Finding(NamedTuple):
    """One statement of the paper and what was found; plain text."""

    where: str  # in the paper
    statement: str  # in our words
    verdict: Verdict
    found: str
    limit: str  # where it stops being true; empty where nothing is known of that


def findings(study: PaperStudy) -> list[Finding]:
    """All statements, in the paper's order."""
    tell: tuple[Callable[[PaperStudy], Finding], ...] = (
        _empty_between_wheels,
        _tension_sets_the_load,
        _traction_between_wheels,
        _counts,
        _wheels_relieved,
        _softer,
        _separation,
        _stabilisation,
        _constant_speed,
        _peak,
        _measured_amplitude,
        _higher_harmonics,
        _share,
        _acceleration,
        _cheap,
    )
    return [one(study) for one in tell]


def unmoved_reach(study: PaperStudy) -> tuple[float, float]:
    """From which to which factor of the imaginary stiffness the rms acceleration hardly changes."""
    reference = study.stiffness[1.0].acceleration_rms
    return reach(study.stiffness, 1.0, lambda f: abs(f.acceleration_rms / reference - 1) <= HARDLY)


def peak_reach(study: PaperStudy) -> tuple[float, float]:
    """From which to which factor of the imaginary stiffness the highest peak stays where the waves excite."""
    return reach(study.stiffness, 1.0, _follows)


def steady_harmonic(study: PaperStudy) -> float:
    """The strongest harmonic at exactly constant speed, as a part of the fundamental."""
    return max(study.prescribed.harmonics[1:]) / study.prescribed.harmonics[0]


def amplitude(study: PaperStudy) -> float:
    """Of the study's waves, m."""
    road = study.run.config.road
    assert isinstance(road, SineRoad)
    return road.amplitude


def _empty_between_wheels(study: PaperStudy) -> Finding:
    share, bare = study.paper.figures.static_share, _preloads(study)[0.0].static_share
    return Finding(
        "2.1",
        "On hard flat ground there is almost no pressure between the road wheels.",
        "holds" if share < LITTLE else "does not hold here",
        f"At rest on flat ground the imaginary wheels carry {share_words(share)} of the weight; without any preload "
        f"of their springs still {share_words(bare)}, because they and their links have weight of their own.",
        "The model would need lighter imaginary wheels than Table 1's to show an unloaded stretch of track.",
    )


def _tension_sets_the_load(study: PaperStudy) -> Finding:
    preloads = _preloads(study)
    shares = [figures.static_share for figures in preloads.values()]
    return Finding(
        "2.1",
        "The load between the road wheels varies with the tension of the track.",
        "holds" if _rises(shares) else "does not hold here",
        f"The springs' preload stands for tension: wound up by {_series(preloads, 1e3, 'mm')}, the imaginary wheels "
        f"carry {list_words([share_words(share) for share in shares])} at rest.",
        "The paper does not give the preload, so that the share itself is our choice.",
    )


def _traction_between_wheels(study: PaperStudy) -> Finding:
    preloads = _preloads(study)
    shares = [figures.traction_share for figures in preloads.values()]
    return Finding(
        "2.1",
        "On uneven ground the track between the road wheels pulls too, the more the tighter it is.",
        "holds" if _rises(shares) else "does not hold here",
        f"On the paper's road the imaginary wheels have {list_words([share_words(share) for share in shares])} of the "
        f"mean traction, forward or back, at a preload of {_series(preloads, 1e3, 'mm')}.",
        "Where the vehicle is pulled along instead of driven through its wheels, traction only spins them up and "
        f"down, and they have {share_words(study.prescribed.traction_share)} of it.",
    )


def _counts(study: PaperStudy) -> Finding:
    system = study.run.system
    bodies, joints = len(system.mass), len(system.joint_i)
    n = system.n
    return Finding(
        "2.2, 4",
        "The model has 23 bodies with 69 coordinates, and 22 joints with 44 constraint equations.",
        "holds" if (bodies, joints) == (23, 22) else "does not hold here",
        f"{bodies} bodies, {3 * bodies} coordinates, {joints} joints, {2 * joints} constraint equations, "
        f"{3 * bodies - 2 * joints} degrees of freedom.",
        f"They follow from the {n} road wheels: n wheels make 4n − 1 bodies. The model runs with {WHEEL_COUNT[0]} to "
        f"{WHEEL_COUNT[1]}.",
    )


def _wheels_relieved(study: PaperStudy) -> Finding:
    with_track, without = study.paper.figures, study.no_track
    less = with_track.static_road_load / without.static_road_load - 1
    peak = with_track.load_peak / without.load_peak - 1
    ground = study.run.system.ground
    sunk, deeper = (1e3 * depth(ground, f.static_road_load) for f in (with_track, without))
    verdict: Verdict = "does not hold here" if less >= 0 else "holds" if peak < 0 else "holds within limits"
    on_waves = "fall too" if peak < 0 else "do not fall"
    return Finding(
        "2.2",
        "Imaginary wheels enlarge the contact area and so lower the load and the sinkage of the road wheels.",
        verdict,
        f"At rest a road wheel carries {without.static_road_load / 1e3:.2f} kN without and "
        f"{with_track.static_road_load / 1e3:.2f} kN with imaginary wheels ({change_words(less)}), although they add "
        f"their own weight; it sinks in {deeper:.1f} and {sunk:.1f} mm.",
        f"On the waves the highest loads {on_waves}: {without.load_peak / 1e3:.1f} kN without, "
        f"{with_track.load_peak / 1e3:.1f} kN with them ({change_words(peak)}).",
    )


def _softer(study: PaperStudy) -> Finding:
    vehicle = study.run.config.vehicle
    imaginary, road = vehicle.imaginary_suspension.stiffness, vehicle.road_suspension.stiffness
    assert isinstance(imaginary, float)
    assert isinstance(road, float)
    part, unit = imaginary / road, 1e-3
    _, high = unmoved_reach(study)
    last, most = _ends(study.stiffness)[1]
    more = most.acceleration_rms / study.stiffness[1.0].acceleration_rms
    return Finding(
        "2.2",
        "The imaginary springs' stiffness is quite lower than the road wheels'.",
        "holds" if part < QUITE_LOWER else "does not hold here",
        f"Table 1 has {unit * imaginary:g} beside {unit * road:.1f} kN/m: {share_words(part)}, both read as rates at "
        "the wheel.",
        f"The model needs it. Up to {high:g} times Table 1's, {share_words(high * part)} of the road wheels', the "
        f"acceleration hardly changes. At {last:g} times, {share_words(last * part)}, imaginary wheels "
        f"carry {share_words(most.static_share)} of the weight at rest, and the rms acceleration is {more:.1f} times "
        "as high.",
    )


def _separation(study: PaperStudy) -> Finding:
    paper = study.paper.figures
    calm = [a for a in study.amplitudes if study.amplitudes[a].air == 0]
    return Finding(
        "3",
        "Contact needs forces rather than constraints, because wheels leave the ground and slip.",
        "holds" if paper.air > 0 or paper.slipping > 0 else "does not hold here",
        f"On the paper's road the road wheel that flies most is in the air for {share_words(paper.air)} of the time, "
        f"and the wheel that slips most is at the limit of friction for {share_words(paper.slipping)}.",
        f"Up to an amplitude of {1e3 * max(calm):g} mm no road wheel leaves the ground: there constraints would do."
        if calm
        else f"Wheels fly even at {1e3 * min(study.amplitudes):g} mm amplitude.",
    )


def _stabilisation(study: PaperStudy) -> Finding:
    with_it, without, tight = (f.drift for f in (study.paper.figures, study.unstabilised, study.unstabilised_tight))
    return Finding(
        "4",
        "Baumgarte's stabilisation keeps the joints together.",
        "holds" if with_it < without else "does not hold here",
        f"In the whole run of {study.unstabilised.duration:.0f} s the joints are never more than "
        f"{length_words(with_it)} apart; without it they drift apart by {length_words(without)}.",
        f"That drift is the integrator's errors adding up, and goes with its tolerance: {length_words(tight)} at rtol "
        f"{number_text(TIGHT['simulation.rtol'])} and atol {number_text(TIGHT['simulation.atol'])}. Without "
        "stabilisation the rms acceleration of the run changes by "
        f"{change_words(study.unstabilised.acceleration_rms / study.paper.figures.acceleration_rms - 1)}.",
    )


def _constant_speed(study: PaperStudy) -> Finding:
    swing = study.paper.figures.speed_swing
    change = study.prescribed.acceleration_rms / study.paper.figures.acceleration_rms - 1
    return Finding(
        "5",
        "The vehicle runs over the waves at a constant 15 km/h.",
        "holds within limits" if swing > 0.01 else "holds",
        f"Driven through its wheels by our speed controller it keeps the speed within ±{swing:.2f} km/h.",
        "The paper does not say how the speed was kept. Held exactly, by a force on the hull, rms acceleration "
        f"changes by {change_words(change)}.",
    )


def _peak(study: PaperStudy) -> Finding:
    paper = study.paper.figures
    slow, fast = reach(study.speeds, study.run.config.drive.speed_kmh, _follows)
    _, stiff = peak_reach(study)
    beyond = next((k for k in study.stiffness if k > stiff), None)
    leaves = (
        "the stiffest tried"
        if beyond is None
        else f"at {beyond:g} times the highest peak is at {study.stiffness[beyond].peak_frequency:.2f} Hz"
    )
    seconds = {speed: figures.harmonics[1] / figures.harmonics[0] for speed, figures in study.speeds.items()}
    worst = max(seconds, key=lambda speed: seconds[speed])
    return Finding(
        "5, Fig. 6",
        "The spectrum of the hull's vertical acceleration peaks at 0.6 Hz, at which waves of 7 m are met at 15 km/h.",
        "holds" if _follows(paper) and abs(paper.peak_frequency - PAPER_PEAK) <= NEAR else "does not hold here",
        f"The highest peak is at {paper.peak_frequency:.2f} Hz, {paper.harmonics[0]:.2f} m/s² high; v/λ is "
        f"{paper.excitation:.3f} Hz.",
        f"It follows v/λ at all speeds tried from {slow:g} to {fast:g} km/h, and up to {stiff:g} times the imaginary "
        f"stiffness ({leaves}). The second harmonic comes closest at {worst:g} km/h, with "
        f"{share_words(seconds[worst])} of the first.",
    )


def _measured_amplitude(study: PaperStudy) -> Finding:
    own, bare = study.paper.figures.harmonics[0], study.no_track.harmonics[0]
    amplitudes = [a.figures.harmonics[0] for a in study.alternatives]
    alike = abs(bare / own - 1) < HARDLY
    return Finding(
        "5, Figs. 5 and 6; 6",
        "Simulated and measured amplitudes at 0.6 Hz match excellently, which validates the model.",
        "cannot be compared",
        "The copy of the paper that this project has is without its figures, and its text gives neither amplitude. "
        f"Ours is {own:.2f} m/s² at v/λ, for whoever has Fig. 6 at hand.",
        f"With other values for what the paper leaves open (table below) it is between {min(amplitudes):.2f} and "
        f"{max(amplitudes):.2f} m/s². Without any imaginary wheels it is {bare:.2f} m/s²"
        + (": a match would say little about the model of the track." if alike else "."),
    )


def _higher_harmonics(study: PaperStudy) -> Finding:
    steady, loose = steady_harmonic(study), max(study.loose.harmonics[1:]) / study.loose.harmonics[0]
    low, high = study.amplitudes[min(study.amplitudes)], study.paper.figures
    small = max(low.harmonics[1:]) / low.harmonics[0]
    needed = steady < NOTABLE <= loose
    if needed:
        cause = "Only an unsteady speed brings them here"
    elif steady < NOTABLE:
        cause = "The model has hardly any, whether its speed is constant or not"
    else:
        cause = "The model has them without it"
    return Finding(
        "5",
        "Higher harmonics in the measurement may come from a speed that was not kept constant.",
        "holds" if needed else "does not hold here",
        f"{cause}: the strongest is {share_words(steady)} of the fundamental at exactly constant speed, and "
        f"{share_words(loose)} with a speed that swings by ±{study.loose.speed_swing:.2f} km/h.",
        f"They grow with the waves, from {share_words(small)} at {1e3 * min(study.amplitudes):g} mm amplitude to "
        f"{share_words(max(high.harmonics[1:]) / high.harmonics[0])} at {1e3 * amplitude(study):g} mm"
        + (
            ", where a road wheel flies and lands again. That is another cause than the paper's, which its "
            "measurement may well have had besides."
            if high.air > 0 and low.air == 0
            else "."
        ),
    )


def _share(study: PaperStudy) -> Finding:
    first, last = _ends(study.stiffness)
    rises = _rises([figures.share for figures in study.stiffness.values()])
    same_first, same_last = _ends(study.stiffness_same_force)
    depends = same_last[1].share - same_first[1].share < 0.5 * (last[1].share - first[1].share)
    return Finding(
        "5",
        "The stiffness of the imaginary springs sets the share of the load that imaginary wheels carry.",
        ("holds within limits" if depends else "holds") if rises else "does not hold here",
        f"Their mean share goes from {share_words(first[1].share)} at {first[0]:g} times the stiffness of Table 1 "
        f"through {share_words(study.stiffness[1.0].share)} to {share_words(study.stiffness[3.0].share)} at 3 times "
        f"and {share_words(last[1].share)} at {last[0]:g} times.",
        "It is the preload that carries: this is so if a stiffer spring is wound up by the same angle. With the same "
        f"preload force at every stiffness the share only goes from {share_words(same_first[1].share)} to "
        f"{share_words(same_last[1].share)}."
        if depends
        else "It is so with the same preload force at every stiffness, too.",
    )


def _acceleration(study: PaperStudy) -> Finding:
    reference = study.stiffness[1.0].acceleration_rms
    low, high = unmoved_reach(study)
    most = _ends(study.stiffness)[1][1]
    changes = [study.stiffness[k].acceleration_rms / reference - 1 for k in study.stiffness if low <= k <= high]
    beyond = next((k for k in study.stiffness if k > high), None)
    everywhere = beyond is None and low == min(study.stiffness)
    after = ""
    if beyond is not None:
        after = (
            f" At {beyond:g} times it is {change_words(study.stiffness[beyond].acceleration_rms / reference - 1)}, at "
            f"{max(study.stiffness):g} times {most.acceleration_rms / reference:.1f} times as much, with a road wheel "
            f"in the air for {share_words(most.air)} of the time"
        )
        after += ": imaginary wheels then carry the vehicle." if most.static_share > 0.5 else "."
    return Finding(
        "5",
        "The stiffness of the imaginary springs hardly matters for the vertical acceleration.",
        "holds" if everywhere else "holds within limits" if high > 1.0 else "does not hold here",
        f"From {low:g} to {high:g} times the stiffness of Table 1 the rms acceleration, {reference:.2f} m/s², changes "
        f"by {change_words(min(changes))} to {change_words(max(changes))}.",
        f"It holds up to {high:g} times, if {100 * HARDLY:g} % counts as hardly.{after}",
    )


def _cheap(study: PaperStudy) -> Finding:
    factor = 1 / study.paper.figures.computing
    return Finding(
        "1, 6",
        "Imaginary wheels spare the cost of modelling every link of the track, so that the model can serve a vehicle "
        "simulator.",
        "holds" if factor > 1 else "does not hold here",
        f"On this machine, as it is now, a second of the paper's run takes {1e3 / factor:.1f} ms to compute: "
        f"{factor:.0f} times real time.",
        "There is no model of the track's links here to compare its cost with.",
    )


def _follows(figures: Figures) -> bool:
    return figures.follows_waves


def _preloads(study: PaperStudy) -> dict[float, Figures]:
    """Preload deflection, m -> figures; rising."""
    found = {a.value: a.figures for a in study.alternatives if a.key == PRELOAD}
    own = study.run.config.vehicle.imaginary_suspension.preload_deflection
    return dict(sorted({**found, own: study.paper.figures}.items()))


def _ends(sweep: Mapping[float, Figures]) -> tuple[tuple[float, Figures], tuple[float, Figures]]:
    """The first and the last of a sweep, each with its value."""
    first, last = min(sweep), max(sweep)
    return (first, sweep[first]), (last, sweep[last])


def _rises(values: list[float]) -> bool:
    return bool((np.diff(values) > 0).all())


def _series(values: Mapping[float, Figures], factor: float, unit: str) -> str:
    return f"{list_words([f'{factor * value:g}' for value in values])} {unit}"
