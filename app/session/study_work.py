"""What the tab "Study" is filled with: from what is shown and chosen to data that the page draws, coarse to fine.

Nothing here knows when it runs: app/session/studies.py says so, through `evaluate`.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from app.format.command_line import Source
from app.format.units import METRIC, Units
from app.plots.study_data import (
    Data,
    limits_data,
    map_command,
    map_data,
    measured_data,
    profile_commands,
    profile_data,
)
from app.runs.study_choice import (
    COLUMNS,
    LIMITS,
    MAP,
    MEASURED,
    PROFILER,
    WHAT_IF,
    StudyChoice,
    figures_of,
    keys_of,
    variable_keys,
)
from model.config.config import Config
from model.config.parameters import Value
from model.study.design import DesignError
from model.study.figure_map import figure_maps
from model.study.fit import SPREAD, Fit, Signal, fit, laid_over
from model.study.limits import Limit, course_of, limits
from model.study.profiler import LEVELS, Found, Profile, axis_of, profiles, span_text
from model.study.running import Evaluate, Outcome, blocks

FINISH = 10  # steps of least squares that a fit takes, about
COUNTED = 8  # runs of a fit between two words of how far it has come
VEHICLES = 12  # whose limits are remembered
ANY_RUN: dict[str, Value] = {"drive.speed_kmh": 10.0, "simulation.duration": 10.0}  # limits do not depend on these

Work = Iterator[tuple[str, Data]]  # kind of data, one of VIEWS, and the data


@dataclass(frozen=True, eq=False)
class Record:
    """A measured vertical acceleration."""

    name: str  # of its file
    signal: Signal


class Means(NamedTuple):
    """How studies are run. Each raises an error of its own where they are given up."""

    evaluate: Evaluate  # figures of jobs
    spread: Callable[[Callable[..., object], Iterable[object]], Iterable[object]]  # what work makes of each item
    show: Callable[[str, Data], None]  # what is known meanwhile


@dataclass(frozen=True)
class Situation:
    """What decides whether there may be a study, and of what."""

    number: int  # of the newest request
    shown: int  # of the request whose run is shown
    touched: bool  # the user has moved a control and may still move it
    config: Config | None  # of the run that is shown; None: no run
    baseline: Config | None
    front: bool  # the tab "Study" is seen
    hurries: bool  # a drive, a page in the background, or a run under way
    record: Record | None = None  # that was uploaded
    units: Units = METRIC  # in which all is told


class StudyWork:
    """Studies of one tab, with what is remembered of those before. One at a time."""

    def __init__(self, presets: Mapping[str, Config]) -> None:
        """presets: those that come with the program, for command lines."""
        self._presets = presets
        self._found = Found()
        self._mapped: tuple[object, ...] = ()  # what the last map is of …
        self._map_known: dict[tuple[Value, Value], Outcome] = {}  # … and its outcomes
        self._fits = 0  # number of the last fit that was begun
        self._fit: tuple[tuple[object, ...], Fit] | None = None  # what it is about, and what it found
        self._limited: OrderedDict[Config, dict[tuple[str, str, int], Limit]] = OrderedDict()

    def of(self, situation: Situation, choice: StudyChoice, means: Means) -> Work:
        """What is to be shown, one after the other."""
        assert situation.config is not None
        base, baseline, view = situation.config, situation.baseline, choice.view if situation.front else ""
        evaluate, units = means.evaluate, situation.units
        if view == PROFILER or choice.strips:
            yield from self._profile(base, baseline, choice, view == PROFILER, evaluate, units)
        if view == MAP:
            yield from self._map(base, choice, evaluate, units)
        if view == LIMITS:
            yield from self._limits(base, baseline, evaluate, units)
        if view == MEASURED and situation.record is not None:
            yield from self._measured(base, situation.record, choice, means, units)

    def _profile(
        self,
        base: Config,
        baseline: Config | None,
        choice: StudyChoice,
        whole: bool,
        evaluate: Evaluate,
        units: Units,
    ) -> Work:
        """The profile, and that of the baseline; whole: finer than the strips on the sliders need it."""
        columns, rows = keys_of(choice.columns, base), figures_of(choice.rows, base)
        strips = keys_of(WHAT_IF, base)
        axes = [axis for key in dict.fromkeys((*columns, *strips)) if (axis := axis_of(base, key)) is not None]
        figures = figures_of((*choice.rows, choice.figure), base)
        (chosen,) = figures_of([choice.figure], base)
        source = Source(base, self._presets)

        def told(profile: Profile, other: Profile | None) -> tuple[str, Data]:
            data = profile_data(profile, other, rows, columns, units)
            commands = profile_commands(profile, source, rows, columns)
            return PROFILER, data | {"commands": commands, "note": source.note, "figure": chosen}

        latest: Profile | None = None
        other: Profile | None = None
        for latest in profiles(base, axes, figures, evaluate, self._found, LEVELS if whole else LEVELS[:1]):
            yield told(latest, other)
        if not whole or baseline is None or baseline == base or latest is None:
            return
        axes = [axis for axis in axes if axis.key in keys_of([axis.key], baseline)]
        if not axes:
            return
        for other in profiles(baseline, axes, figures, evaluate, self._found):
            yield told(latest, other)

    def _map(self, base: Config, choice: StudyChoice, evaluate: Evaluate, units: Units) -> Work:
        """The map; the one that was shown last is kept while only its own two parameters change."""
        keys = keys_of((choice.x, choice.y, *COLUMNS), base)[:2]
        (figure,) = figures_of([choice.of], base)
        x, y = (axis_of(base, key) for key in keys)
        assert x is not None
        assert y is not None
        about = (base.replace({x.key: x.low, y.key: y.low}), x, y, figure)
        if about != self._mapped:
            self._mapped, self._map_known = about, {}
        source = Source(base, self._presets)
        for of in figure_maps(base, x, y, figure, evaluate, self._map_known):
            yield MAP, map_data(of, units) | {"commands": [map_command(of, source)], "note": source.note}

    def _limits(self, base: Config, baseline: Config | None, evaluate: Evaluate, units: Units) -> Work:
        """The limits of the vehicle ground by ground, then those of the baseline, then those on more random roads."""
        own, source = self._speeds(base), Source(base, self._presets)
        other = self._speeds(baseline) if baseline is not None else {}
        courses = course_of(base)
        compared = baseline is not None and other is not own
        work = [(base, own, course) for course in courses[:1]]
        if baseline is not None and compared:
            work += [(baseline, other, course) for course in course_of(baseline)[:1]]
        work += [(base, own, course) for course in courses[1:]]
        total, done = sum(len(course) for _, _, course in work), 0
        command = source.command("limits", "--seeds", str(len(courses)), "--out", "limits")
        for config, known, course in work:
            for ground in course:
                done += 1
                name = (ground.family, ground.name, ground.seed)
                if name in known and done < total:
                    continue
                if name not in known:
                    (known[name],) = limits([(config, [ground])], evaluate)
                others = list(other.values()) if compared else []
                data = limits_data(list(own.values()), others, done / total, units)
                yield LIMITS, data | {"commands": [command], "note": source.note}

    def _speeds(self, config: Config) -> dict[tuple[str, str, int], Limit]:
        """The limits known of a vehicle, by ground, whatever road and speed its run has."""
        vehicle = config.replace({"road.type": "flat", **ANY_RUN})
        found = self._limited.setdefault(vehicle, {})
        self._limited.move_to_end(vehicle)
        while len(self._limited) > VEHICLES:
            self._limited.popitem(last=False)
        return found

    def _measured(self, base: Config, record: Record, choice: StudyChoice, means: Means, units: Units) -> Work:
        """The run over the record, and the last fit as long as it is about them."""
        keys = variable_keys(base)
        labels = [[key, base.parameter(key).label] for key in keys]
        ranges = [axis for key in choice.fitted if key in keys and (axis := axis_of(base, key)) is not None]
        about = (base, record, choice.low_pass, choice.fitted)
        try:
            over = laid_over(base, record.signal, choice.low_pass)
        except DesignError as error:
            yield MEASURED, {"name": record.name, "said": str(error), "fit": None, "busy": ""}
            return

        def told(busy: str = "", said: str = "") -> Data:
            found = self._fit[1] if self._fit is not None and self._fit[0] == about else None
            return measured_data(base, record.name, over, found, units) | {"busy": busy, "said": said, "keys": labels}

        asked = choice.fit != self._fits and bool(ranges)
        yield MEASURED, told("Fitting…" if asked else "")
        if not asked:
            return
        self._fits = choice.fit
        total, done = SPREAD * len(ranges) + FINISH * (len(ranges) + 1), 0

        def counted(work: Callable[..., object], items: Iterable[object]) -> list[object]:
            nonlocal done
            found: list[object] = []
            for block in blocks(items, COUNTED):
                found += means.spread(work, block)
                done += len(block)
                means.show(MEASURED, told(f"Fitting… {min(100 * done // total, 99)} %"))
            return found

        try:
            self._fit = about, fit(base, record.signal, ranges, choice.low_pass, spread=counted)
        except DesignError as error:
            yield MEASURED, told(said=str(error))
        else:
            command = Source(base, self._presets).command(
                "fit", "--measured", record.name, *(f"--over={span_text(axis)}" for axis in ranges), "--out", "fit"
            )
            yield MEASURED, told() | {"commands": [command], "note": ""}
