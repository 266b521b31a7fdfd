"""What the tab "Study" is filled with: from what is shown and chosen to data that the page draws, coarse to fine.

Nothing here knows when it runs: app/session/studies.py says so, through `evaluate`.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from app.format.command_line import Source
from app.format.load_unit import load_unit
from app.plots.study_data import Data, limits_data, map_command, map_data, profile_commands, profile_data
from app.runs.study_choice import COLUMNS, LIMITS, MAP, PROFILER, WHAT_IF, StudyChoice, figures_of, keys_of
from model.config.config import Config
from model.config.parameters import Value
from model.dynamics.vehicle import build_system
from model.study.figure_map import figure_maps
from model.study.limits import Limit, course_of, limits
from model.study.profiler import LEVELS, Found, Profile, axis_of, profiles
from model.study.running import Evaluate, Outcome

VEHICLES = 12  # whose limits are remembered
ANY_RUN: dict[str, Value] = {"drive.speed_kmh": 10.0, "simulation.duration": 10.0}  # limits do not depend on these

Work = Iterator[tuple[str, Data]]  # kind of data, one of VIEWS, and the data


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


class StudyWork:
    """Studies of one tab, with what is remembered of those before. One at a time."""

    def __init__(self, presets: Mapping[str, Config]) -> None:
        """presets: those that come with the program, for command lines."""
        self._presets = presets
        self._found = Found()
        self._mapped: tuple[object, ...] = ()  # what the last map is of …
        self._map_known: dict[tuple[Value, Value], Outcome] = {}  # … and its outcomes
        self._limited: OrderedDict[Config, dict[tuple[str, str, int], Limit]] = OrderedDict()

    def of(self, situation: Situation, choice: StudyChoice, evaluate: Evaluate) -> Work:
        """What is to be shown, one after the other."""
        assert situation.config is not None
        base, baseline, view = situation.config, situation.baseline, choice.view if situation.front else ""
        if view == PROFILER or choice.strips:
            yield from self._profile(base, baseline, choice, view == PROFILER, evaluate)
        if view == MAP:
            yield from self._map(base, choice, evaluate)
        if view == LIMITS:
            yield from self._limits(base, baseline, evaluate)

    def _profile(
        self, base: Config, baseline: Config | None, choice: StudyChoice, whole: bool, evaluate: Evaluate
    ) -> Work:
        """The profile, and that of the baseline; whole: finer than the strips on the sliders need it."""
        columns, rows = keys_of(choice.columns, base), figures_of(choice.rows, base)
        strips = keys_of(WHAT_IF, base)
        axes = [axis for key in dict.fromkeys((*columns, *strips)) if (axis := axis_of(base, key)) is not None]
        figures = figures_of((*choice.rows, choice.figure), base)
        (chosen,) = figures_of([choice.figure], base)
        source, loads = Source(base, self._presets), load_unit(build_system(base))

        def told(profile: Profile, other: Profile | None) -> tuple[str, Data]:
            data = profile_data(profile, other, loads, rows, columns)
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

    def _map(self, base: Config, choice: StudyChoice, evaluate: Evaluate) -> Work:
        """The map; the one that was shown last is kept while only its own two parameters change."""
        keys = keys_of((choice.x, choice.y, *COLUMNS), base)[:2]
        (figure,) = figures_of([choice.of], base)
        x, y = (axis_of(base, key) for key in keys)
        assert x is not None
        assert y is not None
        about = (base.replace({x.key: x.low, y.key: y.low}), x, y, figure)
        if about != self._mapped:
            self._mapped, self._map_known = about, {}
        source, loads = Source(base, self._presets), load_unit(build_system(base))
        for of in figure_maps(base, x, y, figure, evaluate, self._map_known):
            yield MAP, map_data(of, loads) | {"commands": [map_command(of, source)], "note": source.note}

    def _limits(self, base: Config, baseline: Config | None, evaluate: Evaluate) -> Work:
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
                data = limits_data(list(own.values()), list(other.values()) if compared else [], done / total)
                yield LIMITS, data | {"commands": [command], "note": source.note}

    def _speeds(self, config: Config) -> dict[tuple[str, str, int], Limit]:
        """The limits known of a vehicle, by ground, whatever road and speed its run has."""
        vehicle = config.replace({"road.type": "flat", **ANY_RUN})
        found = self._limited.setdefault(vehicle, {})
        self._limited.move_to_end(vehicle)
        while len(self._limited) > VEHICLES:
            self._limited.popitem(last=False)
        return found
