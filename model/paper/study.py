"""The paper's runs again, and many around them: how far its statements reach, and what our assumptions do to them.

Every run is the paper's vehicle on the paper's road with a value or two changed. Its figures are taken over the last
whole waves, when the start has died away.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import numpy as np

from model.analysis.ride import imaginary_share
from model.analysis.spectrum import amplitude_spectrum, excitation
from model.config.config import Config
from model.config.config_files import load_config
from model.simulation.accuracy import APART_ALLOWED
from model.simulation.simulate import simulate
from model.simulation.trajectory import Trajectory

RUN_IN, WAVES = 3, 6  # waves that a run lasts before its figures are taken, and while they are
SETTLING = 2.0  # s more before
HARMONICS = 3  # multiples of v/λ whose amplitude is told, the first included
SLIPPING = 0.999  # part of the friction limit from which a wheel slips

STIFFNESS = "vehicle.imaginary_suspension.stiffness"
PRELOAD = "vehicle.imaginary_suspension.preload_deflection"
PRELOAD_FORCE = "vehicle.imaginary_suspension.preload_force"
SPEED, AMPLITUDE, MODE = "drive.speed_kmh", "road.amplitude", "drive.mode"
GAINS = ("drive.proportional_gain", "drive.integral_gain")
BAUMGARTE = ("simulation.baumgarte_alpha", "simulation.baumgarte_beta")

FACTORS = (0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0)  # of the imaginary stiffness
SOFT, STIFF = 0.1, 3.0  # the two that are run again under every other assumption
SPEEDS = (5.0, 7.5, 10.0, 12.5, 15.0, 17.5, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0)  # km/h
AMPLITUDES = (0.01, 0.02, 0.04, 0.06, 0.08, 0.09, 0.1, 0.11, 0.12, 0.15)  # m
LOOSE = 0.1  # of the speed controller's gains, for a driver who holds the speed badly
HALF = 0.05  # m: the paper's 100 mm read from crest to trough
TIGHT = {"simulation.rtol": 1e-9, "simulation.atol": 1e-11}

# What the paper leaves open, and values that it may have had instead of ours
ALTERNATIVES: dict[str, tuple[Any, ...]] = {
    "vehicle.road_wheels.spacing": (0.583,),
    "vehicle.imaginary_suspension.reacts_on": ("chassis",),
    PRELOAD: (0.0, 0.05, 0.2),
    "vehicle.road_arms.length": (0.25, 0.5),
    "vehicle.road_arms.angle_deg": (5.0, 40.0),
    "vehicle.road_arms.mass": (15.0, 60.0),
    "vehicle.road_arms.inertia": (0.6,),
    "vehicle.imaginary_arms.mass": (1.0, 20.0),
    "vehicle.road_wheels.inertia": (7.7,),
    "vehicle.imaginary_wheels.inertia": (7.7,),
    "vehicle.chassis.cg_height": (0.75, 1.15),
    "vehicle.road_wheels.offset": (-0.1, 0.1),
    "contact.normal_stiffness": (6e6, 6e8),
    "contact.normal_damping": (3e6, 3e8),
    "contact.tangential_stiffness": (5e4, 5e6),
    "contact.tangential_damping": (1e3, 1e5),
    "contact.friction": (0.4, 1.0),
    "drive.proportional_gain": (5e3, 8e4),
    "drive.integral_gain": (0.0, 4e4),
    "drive.force_limit": (2e4, 8e4),
    MODE: ("prescribed",),
    AMPLITUDE: (HALF,),
}


class StudyError(RuntimeError):
    """A run of the study did not reach its end; the message says which and why."""


@dataclass(frozen=True)
class Figures:
    """What one run comes to, over its last WAVES waves unless said otherwise. Shares and parts are 0…1."""

    excitation: float  # Hz, v/λ
    peak_frequency: float  # Hz, of the highest amplitude in the spectrum of the hull's vertical acceleration
    resolution: float  # Hz, of that spectrum: 1 / length of the signal
    harmonics: tuple[float, ...]  # m/s², amplitudes at v/λ and its multiples
    acceleration_rms: float  # m/s²
    share: float  # of the load on imaginary wheels, mean over time
    traction_share: float  # of mean |traction| on imaginary wheels
    load_peak: float  # N, highest of all wheels
    air: float  # part of the time in the air, of the road wheel that is there longest
    slipping: float  # part of the time at the limit of friction, of the wheel that is there longest
    speed_swing: float  # km/h, largest difference from the speed to be kept
    static_share: float  # of the load on imaginary wheels, at rest
    static_road_load: float  # N, mean of road wheels at rest
    drift: float  # m, by which joints were apart at worst, in the whole run
    duration: float  # s, of the whole run
    computing: float  # s of computing for each second simulated, in the whole run

    @property
    def follows_waves(self) -> bool:
        """Whether the highest peak is where the waves excite the vehicle."""
        return abs(self.peak_frequency - self.excitation) <= self.resolution


@dataclass(frozen=True)
class Alternative:
    """One assumption changed, and the same with a soft and a stiff track."""

    key: str
    value: Any
    figures: Figures
    soft: Figures  # imaginary stiffness × SOFT
    stiff: Figures  # imaginary stiffness × STIFF


@dataclass(frozen=True)
class PaperStudy:
    """All that is told about the paper. Sweeps: value -> figures, values rising."""

    run: Trajectory  # the preset "paper", for the figures of the paper
    paper: Alternative  # as this project reads the paper; key and value are empty
    stiffness: Mapping[float, Figures]  # over factors, the springs wound up by the same deflection
    stiffness_same_force: Mapping[float, Figures]  # over factors, the springs' preload the same force
    speeds: Mapping[float, Figures]  # km/h
    amplitudes: Mapping[float, Figures]  # m
    no_track: Figures
    prescribed: Figures  # at exactly constant speed
    loose: Figures  # with LOOSE speed control
    unstabilised: Figures  # without Baumgarte's terms
    unstabilised_tight: Figures  # that with TIGHT tolerances
    alternatives: tuple[Alternative, ...]
    half: PaperStudy | None  # the same on waves of amplitude HALF, other preloads its only alternatives; None in that


def study_paper(on_progress: Callable[[float], None] | None = None) -> PaperStudy:
    """All runs, one after the other. on_progress: gets the part done, 0…1, and may raise to end the study.

    Raises StudyError.
    """
    paper = load_config("paper")
    half = paper.replace({AMPLITUDE: HALF}), {PRELOAD: ALTERNATIVES[PRELOAD]}
    count = _count(ALTERNATIVES) + _count(half[1])
    done = 0

    def run(config: Config) -> Figures:
        nonlocal done
        figures = run_figures(config)
        done += 1
        if on_progress is not None:
            on_progress(done / count)
        return figures

    return _study(paper, ALTERNATIVES, run, _study(*half, run, None))


def _count(alternatives: Mapping[str, tuple[Any, ...]]) -> int:
    """How many runs a study with these alternatives takes."""
    return 2 * len(FACTORS) + len(SPEEDS) + len(AMPLITUDES) + 5 + 3 * (1 + sum(map(len, alternatives.values())))


def _study(
    paper: Config,
    alternatives: Mapping[str, tuple[Any, ...]],
    figures: Callable[[Config], Figures],
    half: PaperStudy | None,
) -> PaperStudy:
    """The runs about one reading of the paper. figures: runs a configuration, as run_figures does."""
    stiffness, deflection = _number(paper, STIFFNESS), _number(paper, PRELOAD)

    def run(changes: Mapping[str, Any]) -> Figures:
        return figures(paper.replace(changes))

    def alternative(key: str = "", value: Any = None) -> Alternative:
        changes = {key: value} if key else {}
        others = [run({**changes, STIFFNESS: stiffness * factor}) for factor in (SOFT, STIFF)]
        return Alternative(key, value, run(changes), *others)

    force = {PRELOAD_FORCE: stiffness * deflection}
    bare = dict.fromkeys(BAUMGARTE, 0.0)
    return PaperStudy(
        run=simulate(paper),
        paper=alternative(),
        stiffness={factor: run({STIFFNESS: stiffness * factor}) for factor in FACTORS},
        stiffness_same_force={factor: run({STIFFNESS: stiffness * factor, **force}) for factor in FACTORS},
        speeds={speed: run({SPEED: speed}) for speed in SPEEDS},
        amplitudes={amplitude: run({AMPLITUDE: amplitude}) for amplitude in AMPLITUDES},
        no_track=run({"vehicle.imaginary_wheels.enabled": False}),
        prescribed=run({MODE: "prescribed"}),
        loose=run({gain: LOOSE * _number(paper, gain) for gain in GAINS}),
        unstabilised=run(bare),
        unstabilised_tight=run({**bare, **TIGHT}),
        alternatives=tuple(alternative(key, value) for key, values in alternatives.items() for value in values),
        half=half,
    )


def run_figures(config: Config) -> Figures:
    """Run a configuration on waves for as long as its figures need. Raises StudyError."""
    frequency = excitation(config)
    assert frequency is not None  # there are waves
    lasting = config.replace({"simulation.duration": SETTLING + (RUN_IN + WAVES) / frequency})
    held = any(config.value(key) for key in BAUMGARTE)
    run = simulate(lasting, apart_allowed=APART_ALLOWED if held else np.inf)
    if not run.complete:
        raise StudyError(f"A run of the study is not complete: {run.status}. {run.advice}")
    return figures_of(run, frequency)


def figures_of(run: Trajectory, frequency: float) -> Figures:
    """The figures of a run that meets waves at a frequency, Hz, and lasts WAVES of them at least."""
    system, rate = run.system, run.config.simulation.output_rate
    last = slice(-round(WAVES / frequency * rate), None)
    acceleration = run.a[last, system.chassis, 1]
    load, traction = run.normal_load[last], np.abs(run.traction[last])
    spectrum = amplitude_spectrum(acceleration, rate)
    turns = np.exp(-2j * np.pi * frequency * np.outer(np.arange(1, HARMONICS + 1), run.t[last]))
    rest, n = run.static_load, system.n
    return Figures(
        excitation=frequency,
        peak_frequency=float(spectrum[0][spectrum[1].argmax()]),
        resolution=rate / len(acceleration),
        harmonics=tuple(2 * np.abs((turns @ acceleration) / len(acceleration))),
        acceleration_rms=float(np.sqrt(np.mean(acceleration**2))),
        share=imaginary_share(load, n),
        traction_share=float(traction[:, n:].sum() / traction.sum()),
        load_peak=float(load.max()),
        air=float((load[:, :n] <= 0).mean(axis=0).max()),
        slipping=float(((traction >= SLIPPING * system.ground.mu * load) & (load > 0)).mean(axis=0).max()),
        speed_swing=float(3.6 * np.abs(run.v[last, system.chassis, 0] - system.v_ref).max()),
        static_share=float(rest[n:].sum() / rest.sum()),
        static_road_load=float(rest[:n].mean()),
        drift=float(run.constraint_residual.max()),
        duration=float(run.t[-1]),
        computing=run.statistics.seconds / float(run.t[-1]),
    )


def reach(values: Mapping[float, Figures], start: float, holds: Callable[[Figures], bool]) -> tuple[float, float]:
    """The first and the last value of a sweep between which a statement holds without a gap, around `start`."""
    below = [value for value in sorted(values, reverse=True) if value <= start]
    above = [value for value in sorted(values) if value >= start]
    low, high = ([start, *takewhile(lambda value: holds(values[value]), side)][-1] for side in (below, above))
    return low, high


def _number(config: Config, key: str) -> float:
    value = config.value(key)
    assert isinstance(value, float)
    return value
