"""What the user of one tab keeps at hand: steps back and forth, runs, the baseline, presets of their own.

Only the thread that draws (app/session/session.py) uses it. What is to outlast the page goes to the browser's storage.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from app.format.link import Link
from app.format.units import METRIC, Units
from app.plots.curves import Beside
from app.runs.history import REST, RUN_COLOURS, Changes, Kept, Runs, run_name
from app.runs.project import Project
from app.runs.request import Finished, Request, first_request, same
from app.runs.runner import Runner
from app.runs.storage import PRESETS, State, state_text
from app.runs.study_choice import StudyChoice
from app.session.window import Window
from model.config.config import Config, ConfigError
from model.simulation.trajectory import Trajectory

COMPARE_EVERY = 0.3  # s from one table of figures to the next while runs follow each other and the table is seen…
BESIDE = 8  # kept runs at most that are shown beside the present one
CALM = 0.3  # s … or without another run when it is not


class Standing(NamedTuple):
    """What a user has come to, so that we can lead back to it."""

    done: Finished  # the run that is shown
    baseline: Kept | None


class Workspace:
    """Shows what it keeps in the window, and requests runs. Times are monotonic, in s."""

    def __init__(self, window: Window, runner: Runner, presets: dict[str, Config]) -> None:
        """presets: name -> configuration; those that the user saves are added to it."""
        self._window, self._runner = window, runner
        self._presets = presets
        self._own: list[str] = []  # names of the user's presets, oldest first
        self._start = runner.latest
        self._started_with = self._start.config()
        self._changes = Changes(self._start)
        self._runs = Runs()
        self._good: Finished | None = None  # the run that is shown; None: a drive, or no run yet
        self._good_at = 0.0  # when it came, s
        self._rested = False  # the user has rested on it
        self._kept: Kept | None = None  # the same, once it is kept
        self._before_drive = ""  # name of the run whose figures stay while a drive is shown
        self._baseline: Kept | None = None
        self._ticked: list[int] = []  # numbers of the kept runs that are shown beside
        self._compared = self._named = True  # the table of figures and the name belong to the run that is shown
        self._compared_at = 0.0  # when it was made, s
        self._news_at: float | None = (
            None  # when there was something new for the browser to store, s; None: nothing new
        )
        self._stored = ""
        self._dark: bool | None = None  # the look that the user has chosen
        self._prefers_dark = False
        self._units = METRIC
        self._link: Link | None = None  # to be opened once the browser has told what it has stored
        self._restored = False  # the browser has told what it has stored; from then on we may overwrite it

    @property
    def presets(self) -> Mapping[str, Config]:
        """By name; may be read on any thread."""
        return self._presets

    @property
    def baseline(self) -> Trajectory | None:
        """The run that others are compared with."""
        return None if self._baseline is None else self._baseline.run

    @property
    def present(self) -> Request:
        """What undo and redo have led to: the newest request that came true."""
        return self._changes.present

    @property
    def steps(self) -> tuple[int, Config | None]:
        """Another one at each step that the user takes: of undo, or to another baseline."""
        return self._changes.count, _config_of(self._baseline)

    @property
    def stands(self) -> bool:
        """Whether the browser has told what it has stored, and nothing that was requested is still to come."""
        return self._restored and same(self._runner.latest, self.present)

    @property
    def standing(self) -> Standing | None:
        """What is shown, once nothing more is to come; None before that, and in a drive."""
        if not self.stands or self._good is None or not same(self._good.request, self.present):
            return None
        return Standing(self._good, self._baseline) if len(self._good.trajectory.t) else None

    # ── What happens ──

    def finished(self, done: Finished, now: float) -> None:
        """A run is shown, at `now`, s."""
        fresh = self._good is None or not same(self._good.request, done.request)
        self._good, self._good_at, self._rested, self._before_drive = done, now, False, ""
        self._complete(done.trajectory)
        self._kept = self._runs.find(done.trajectory.config)
        self._compared = False
        self._named &= not fresh
        self._came_true(done.request, now)

    def driven(self, request: Request, now: float) -> None:
        """A drive is shown, at `now`, s."""
        if self._good is not None:
            self._before_drive, self._good, self._kept = self._name, None, None
            self._show()
        self._came_true(request, now)

    def set_dark(self, dark: bool) -> None:
        """Change the look of the page."""
        self._dark = dark
        self._look()
        self._news_at = 0.0

    def choose_units(self, chosen: Mapping[str, str]) -> None:
        """Tell some quantities of the page in other units."""
        self._set_units(self._units.changed(chosen))

    def _set_units(self, units: Units) -> None:
        if units == self._units:
            return
        self._units = units
        self._runs.set_units(units)
        self._kept, self._baseline = (
            None if kept is None else kept.renamed(kept.given_name, units) for kept in (self._kept, self._baseline)
        )
        self._window.set_units(units)
        self._compared, self._compared_at, self._named = False, 0.0, False
        if self._ticked:
            self._show_beside()
        self._note_news()

    def prefer_dark(self, dark: bool) -> None:
        """Take the look that the browser is set to, until the user chooses one."""
        self._prefers_dark = dark
        if self._restored:
            self._look()

    def _look(self) -> None:
        dark = self._prefers_dark if self._dark is None else self._dark
        if dark != self._window.dark:
            self._window.set_dark(dark)

    def tick(self, now: float) -> None:
        """Do what waits until the user rests; `now`, s. To be called several times a second."""
        if self._good is not None and len(self._good.trajectory.t):
            seen = self._window.runs_in_front and now - self._compared_at >= COMPARE_EVERY
            rests = not self._rested and now - self._good_at >= REST and self._settled(self._good.request)
            if seen or rests or now - self._good_at >= CALM:
                self._tell(now)
            if rests:
                self._rested = True
                self._keep(self._good)

    @property
    def missing_run(self) -> Config | None:
        """The configuration of the baseline or a ticked run that has to be made again (see `made_again`); else None."""
        wanted = [*([] if self._baseline is None else [self._baseline]), *self._beside]
        return next((kept.config for kept in wanted if kept.run is None), None)

    def news(self, now: float) -> str | None:
        """The text that the browser is to store, given once, when the user has rested; None: nothing new. `now`, s."""
        if not self._restored or self._news_at is None or now - self._news_at < REST:
            return None
        self._news_at = None
        own = [self._presets[name] for name in self._own]
        state = state_text(
            self._started_with, self._changes.present, own, self._runs, self._baseline, self._dark, self._units
        )
        if state == self._stored:
            return None
        self._stored = state
        return state

    def _came_true(self, request: Request, now: float) -> None:
        if self._settled(request):
            if not same(request, self._changes.present):
                self._news_at = now
            self._changes.note(request, now)
            self._offer(request.base)

    def _settled(self, request: Request) -> bool:
        """Whether no newer request is on its way."""
        return self._runner.latest.number == request.number

    # ── Steps ──

    def go(self, steps: int) -> None:
        """Redo so many steps, or undo them when negative."""
        under_way = not same(self._runner.latest, self._changes.present)
        request = self._changes.go(steps + 1 if under_way and steps < 0 else steps)
        if request is None and under_way and steps < 0:
            request = self._changes.present
        if request is not None:
            self._request(request)
        else:
            self._window.say("Nothing to undo" if steps < 0 else "Nothing to redo", "All parameters stay as they are.")

    # ── Runs and baseline ──

    def pin(self) -> None:
        """Make the run that is shown the baseline."""
        if self._good is None or not len(self._good.trajectory.t):
            self._window.say("Only a run can be pinned", "Change from Drive to Run first.")
            return
        self._set_baseline(self._keep(self._good))
        self._window.say("Baseline pinned", f"{self._name}. Whatever you change now is compared with it.")

    def swap(self) -> None:
        """Show the baseline, and make what is shown now the baseline."""
        if self._good is None or self._baseline is None:
            self._window.say("Nothing to swap", "Pin a run as the baseline (B), then change something.")
            return
        other = self._baseline
        self._set_baseline(self._keep(self._good))
        self._request(other.request)

    def compare_with(self, standing: Standing) -> None:
        """Make the run of a standing, which is shown, the baseline."""
        self._set_baseline(self._keep(standing.done))

    def go_back(self, to: Standing) -> None:
        """Show again what was shown, beside the baseline of then."""
        self._set_baseline(to.baseline)
        self._request(to.done.request)

    def clear_baseline(self) -> None:
        """Compare with no run."""
        self._set_baseline(None)

    def recall(self, number: int) -> None:
        """Show a run that is kept."""
        if number in self._runs:
            self._request(self._runs[number].request)

    def compare(self, number: int) -> None:
        """Make a run that is kept the baseline."""
        if number in self._runs:
            self._set_baseline(self._runs[number])

    def tick_run(self, number: int) -> None:
        """Show a kept run beside the one that is shown, or do so no more."""
        if number in self._ticked:
            self._ticked.remove(number)
        elif len(self._ticked) >= BESIDE:
            self._window.say("Eight at most", f"{BESIDE} runs are shown beside this one. Take one away first.")
        elif number in self._runs:
            self._ticked.append(number)
        self._show_beside()
        self._show()

    @property
    def _beside(self) -> list[Kept]:
        return [self._runs[number] for number in self._ticked if number in self._runs]

    def _show_beside(self) -> None:
        """Show those that are there; those of which only the configuration is left follow when they are made again."""
        self._ticked = [kept.number for kept in self._beside]
        shown = [Beside(kept.name, kept.colour, kept.run) for kept in self._beside if kept.run is not None]
        self._window.show_beside(tuple(shown))
        self._compared, self._compared_at = False, 0.0

    def delete(self, number: int) -> None:
        """Keep a run no more. If it is the baseline, it stays the baseline."""
        self._runs.delete(number)
        if number in self._ticked:
            self._show_beside()
        if self._kept is not None and self._kept.number == number:
            self._kept, self._rested = None, True  # so that it is not kept again at once
        self._note_news()

    def rename(self, name: str) -> None:
        """Name the run that is shown, and keep it."""
        if self._good is None:
            return
        self._kept = self._runs.rename(self._keep(self._good).number, name)
        if self._baseline is not None and self._baseline.number == self._kept.number:
            self._baseline = self._kept
        self._note_news()

    def take_in(self, run: Trajectory, name: str) -> None:
        """Keep a run from outside, and make it the baseline."""
        self._set_baseline(self._runs.keep(Request(run.config), run, name))
        self._window.say("Baseline pinned", f"{name}. What is shown is compared with it.")

    def made_again(self, config: Config, run: Trajectory | None) -> None:
        """Take the run of `missing_run`; None: it could not be made."""
        if run is not None and len(run.t):
            self._complete(run)
        elif self._baseline is not None and self._baseline.config == config:
            self._window.say("No baseline", f"{self._baseline.name} cannot be run again.")
            self.clear_baseline()
        else:
            self._ticked = [kept.number for kept in self._beside if kept.config != config]

    def _complete(self, run: Trajectory) -> None:
        """Give the run to the kept run, and to the baseline, of which only the configuration was left."""
        again = any(kept.run is None and kept.config == run.config for kept in self._beside)
        self._runs.complete(run)
        if again:
            self._show_beside()
        baseline = self._baseline
        if baseline is not None and baseline.run is None and baseline.config == run.config:
            self._set_baseline(replace(baseline, run=run))

    def _keep(self, good: Finished) -> Kept:
        self._kept = self._runs.keep(good.request, good.trajectory)
        self._note_news()
        return self._kept

    def _set_baseline(self, run: Kept | None) -> None:
        self._baseline = None if run is None else run.renamed(run.given_name, self._units)
        self._window.show_baseline(self.baseline)
        self._compared, self._compared_at = False, 0.0
        self._note_news()

    def _note_news(self) -> None:
        """Show runs and baseline, and have the browser store them soon."""
        self._news_at = 0.0
        self._show()

    @property
    def _name(self) -> str:
        """The name of the run that is shown."""
        if self._kept is not None:
            return self._kept.name
        return (
            "" if self._good is None else run_name(self._good.request.base, self._good.trajectory.config, self._units)
        )

    def _show(self) -> None:
        self._window.runs.show(self._runs, self._name, self._kept, self._baseline, self._before_drive, self._ticked)

    def _tell(self, now: float) -> None:
        """Show name and figures of the run, unless they are shown already."""
        assert self._good is not None
        if not self._named:
            self._named = True
            self._show()
            self._window.runs.show_name(self._name)
        if not self._compared:
            beside = [Beside(kept.name, kept.colour, kept.run) for kept in self._beside if kept.run is not None]
            self._window.runs.compare(self._good.trajectory, self.baseline, beside, self._units)
            self._compared, self._compared_at = True, now

    # ── Configurations ──

    def use_configuration(self, config: Config) -> None:
        """Request a configuration from outside; as changes to the present preset if both have the same name."""
        base = self._runner.latest.base
        self._request(first_request(base, config) if config.name == base.name else Request(config))

    def open(self, link: Link) -> None:
        """Request configuration and baseline of a link, once the browser has told what it has stored."""
        if not self._restored:
            self._link = link
            return
        if _config_of(self._baseline) != link.baseline:
            self._set_baseline(
                None if link.baseline is None else self._linked_baseline(link.baseline_preset, link.baseline)
            )
        if not _asks_for(self._runner.latest, link.config):
            self._request(first_request(self._presets[link.preset], link.config))

    def _linked_baseline(self, preset: str, config: Config) -> Kept:
        return self._runs.find(config) or _to_be_run(first_request(self._presets[preset], config))

    def change_road(self, changes_of: Callable[[Config], dict[str, Any]]) -> None:
        """Request changes (dotted key -> value) to the road of the latest request, if that request is valid."""

        def changed(request: Request) -> Request:
            try:
                changes = changes_of(request.config())
            except ConfigError:  # it will be refused
                return request
            for key, value in changes.items():
                request = request.changed(key, value)
            return Request(request.base, request.changes)

        self._runner.change(changed)

    def save_preset(self, name: str) -> None:
        """Make a preset of the configuration that is shown."""
        if self._good is None:
            return
        name = " ".join(name.split())
        if not name:
            self._window.say("No name", "Give the preset a name first.")
            return
        try:
            config = self._good.trajectory.config.replace({"name": name})
        except ConfigError as error:
            self._window.show_faults("This name cannot be used", error)
            return
        for own in self._own:
            if self._presets[own].name == name:
                self._presets[own] = config
        self._offer(config)
        self._request(Request(config))
        self._news_at = 0.0
        self._window.say("Preset saved", f"{name} is among the presets of this browser.")

    def _offer(self, base: Config) -> None:
        """Show this preset as the chosen one; add it if it is new."""
        name = next((name for name, config in self._presets.items() if config == base), "")
        if not name:
            name = next(f"own {k}" for k in range(1, PRESETS + 2) if f"own {k}" not in self._presets)
            self._own.append(name)
            self._presets[name] = base
            if len(self._own) > PRESETS:
                del self._presets[self._own.pop(0)]
        self._window.show_presets(self._presets, name)

    def _request(self, request: Request) -> None:
        """Request this; the controls follow, since the user has touched none."""
        self._runner.change(lambda latest: Request(request.base, request.changes))

    # ── Projects ──

    def project(self, study: StudyChoice) -> Project:
        """All that is at hand; the run that is shown is kept for it."""
        if self._good is not None and len(self._good.trajectory.t):
            self._keep(self._good)
        runs = tuple(self._runs)
        ticked = tuple(place for place, kept in enumerate(runs) if kept.number in self._ticked)
        own = tuple(self._presets[name] for name in self._own)
        return Project(self._changes.present, own, runs, ticked, self._baseline, study)

    @property
    def at_hand(self) -> str:
        """What would be lost if a project were opened, in words; empty: nothing that the user has taken care of."""
        runs = sum(kept is not self._kept or kept.named for kept in self._runs)
        lost = [f"{runs} kept run{'s' if runs > 1 else ''}"] if runs else []
        return " and ".join([*lost, *(["the baseline"] if self._baseline is not None else [])])

    def open_project(self, project: Project) -> None:
        """Let it take the place of runs, baseline, choices and parameters; its presets come to those that there are."""
        for kept in tuple(self._runs):
            self._runs.delete(kept.number)
        self._kept, self._rested = None, True  # what is shown now is not kept again
        for preset in project.presets:
            if preset not in self._presets.values():
                self._offer(preset)
        self._offer(self._runner.latest.base)
        taken = [self._runs.take_back(kept).number for kept in project.runs]
        self._ticked = [taken[place] for place in project.ticked]
        self._show_beside()
        baseline = project.baseline
        self._set_baseline(None if baseline is None else self._runs.find(baseline.config) or baseline)
        self._window.study.choose(project.study)
        self._request(project.shown)
        self._window.say("Project opened", "Undo leads back to the parameters that were shown before.")

    # ── From one visit to the next ──

    def restore(self, state: State | None) -> None:
        """Go on where this browser was at its last visit; None: the browser told nothing.

        Look, presets and runs are there again in any case; parameters and baseline unless a link says others, the
        explorer was started with something else, or the user is at work already.
        """
        self._restored = True
        if state is not None and self._dark is None:
            self._dark = state.dark
        self._look()
        if state is not None and self._units == METRIC:
            self._set_units(state.units)
        if state is not None:
            self._take_stock(state)
        link, self._link = self._link, None
        if link is not None and (state is None or not _was_shown(link, state)):
            self.open(link)
        elif state is not None:
            self._go_on(state)

    def _take_stock(self, state: State) -> None:
        """Have presets and runs again."""
        for preset in state.presets:
            if preset not in self._presets.values():
                self._offer(preset)
        self._offer(self._runner.latest.base)
        for kept in state.runs:
            self._runs.take_back(kept)
        self._show()

    def _go_on(self, state: State) -> None:
        """Have parameters and baseline again."""
        latest = self._runner.latest
        if state.start != self._started_with or latest.number != self._start.number:
            return
        if state.baseline is not None and self._baseline is None:
            self._set_baseline(self._runs.find(state.baseline.config) or state.baseline)
        if state.request is not None and not same(state.request, latest):
            self._request(state.request)
            self._window.say("Welcome back", "All parameters are as you left them. Undo leads back to the start.")


def _config_of(kept: Kept | None) -> Config | None:
    return None if kept is None else kept.config


def _was_shown(link: Link, state: State) -> bool:
    """Whether a link says what the browser was shown last."""
    shown = None if state.request is None else state.request.config()
    return (shown, _config_of(state.baseline)) == (link.config, link.baseline)


def _asks_for(request: Request, config: Config) -> bool:
    """Whether a request, which may be no valid one, is for this configuration."""
    try:
        return request.config() == config
    except ConfigError:
        return False


def _to_be_run(request: Request) -> Kept:
    """A run that is not made yet, for a baseline."""
    config = request.config()
    return Kept(0, request, config, None, run_name(request.base, config), RUN_COLOURS[1], named=False)
