"""What one browser tab shows. No locks: only the thread that draws (app/session/session.py) changes anything here."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import monotonic
from typing import Any, NamedTuple

import numpy as np
import viser

from app.files.uploads import ProfileQuestion
from app.format.colours import wheel_palette
from app.format.link import Look
from app.format.load_unit import load_unit
from app.format.markup import element
from app.format.parameters import choice_words, refusal
from app.format.units import METRIC, Units
from app.panels.actions import Actions
from app.panels.address_bar import AddressBar
from app.panels.configuration_windows import YamlWindow, show_faults
from app.panels.controls import PRECISION
from app.panels.export_list import ExportList
from app.panels.files_panel import FilesPanel
from app.panels.notifications import Notifications
from app.panels.page_layout import PageLayout, page_layout
from app.panels.page_setup import (
    add_hints,
    add_page,
    apply_theme,
    layout_html,
    listen,
    store_place,
    store_visit,
    title_html,
)
from app.panels.palette import add_palette
from app.panels.parameter_panel import ParameterPanel
from app.panels.playback_panel import PlaybackPanel, covered
from app.panels.plot_panel import RUNS, STUDY, TABS, PlotPanel
from app.panels.profile_form import ProfileForm
from app.panels.question import ask
from app.panels.runs_panel import RunsPanel
from app.panels.shortcuts import add_shortcuts
from app.panels.status_line import BUSY_DELAY, drive_facts, progress_line, run_line, status_line
from app.panels.study_panel import StudyPanel
from app.panels.tour import Tour
from app.panels.units_panel import UnitsPanel
from app.panels.view_panel import ViewPanel
from app.panels.wheel_card import WheelCard
from app.plots.curves import Beside
from app.runs.drive import DriveState
from app.runs.playback import Playback
from app.runs.request import Driven, Failed, Finished, Refused, Request
from app.runs.tab_place import Place
from app.session.vehicle_view import VehicleView
from app.tabs.road_profile import RoadAhead
from app.view3d.mode_animation import PERIOD, ModeShow
from model.config.config import Config, ConfigError
from model.config.parameters import PARAMETER
from model.config.validation import shorten
from model.road.road import Road
from model.simulation.trajectory import Trajectory, wheel_names

ROAD_EVERY = 0.35  # s between two side views of the road
FOLDERS = "View", "Export", "Import and presets"
LAID_OUT_WITHIN = 3.0  # s in which a page tells that its panels are laid out; after that we take it that they are


class InView(NamedTuple):
    """What the 3-D view shows."""

    run: Trajectory  # or the newest moments of a drive
    road: Road | None  # under a drive; None: a run
    baseline: Trajectory | None
    beside: tuple[Beside, ...]


class Window:
    """Panels, plots and 3-D view of one tab."""

    def __init__(
        self,
        client: viser.ClientHandle,
        presets: Mapping[str, Config],
        preset: str,
        config: Config,
        actions: Actions,
        make_view: Callable[[viser.ClientHandle, bool], VehicleView],
    ) -> None:
        self._client, self._actions, self._presets = client, actions, presets
        self._dark = False  # until the browser tells its setting
        self._units = METRIC  # until it tells others
        self._run: Trajectory | None = None
        self._baseline: Trajectory | None = None
        self._beside: tuple[Beside, ...] = ()
        self._viewed_beside: tuple[Beside, ...] = ()  # those that the 3-D view shows
        self._drive: DriveState | None = None  # the newest state of the drive that is shown
        self._drawn: tuple[int, float] | None = None  # run and time that the 3-D view shows
        self._to_view: Trajectory | None = None  # a run that the 3-D view does not have yet
        self._stands_at = monotonic() + LAID_OUT_WITHIN  # when the panels of the page are laid out, s
        self._filled = False  # the page also has what is not seen at first
        self._mode: ModeShow | None = None  # shown in the place of the run
        self._held = False  # the 3-D view shows what a picture or a movie is made of
        self._ghost_hidden = False  # the baseline's vehicle is of another size
        self._run_number = 0
        self._standpoint = ""  # from which the user last chose to look
        self._to_look: tuple[Config, Look] | None = None  # for when this vehicle is shown
        self._road_due = 0.0  # monotonic s
        self._road_ahead = RoadAhead()
        self._notifications = Notifications(client)
        self._large = False  # the plots stand over the view
        self._layout = layout = page_layout(client.camera.image_width, client.camera.image_height)  # until it is told
        gui = client.gui
        with client.atomic():
            apply_theme(gui, self._dark)
            gui.set_panel_label("Trackride")
            gui.main_panel.dock_left()
            self._signs = signs = add_page(gui)
            listen(signs, actions, lambda *typed: self._controls.enter(*typed))
            self.address, self.tour = AddressBar(gui), Tour(gui)
            self._opened, self._tabs_opened = gui.add_html(""), 0
            self._controls = ParameterPanel(gui, presets, preset, config, actions)
            with self._controls.middle:
                self._folders = [gui.add_folder(name, expand_by_default=False) for name in FOLDERS]
            self._plots_panel = gui.add_panel()
            self._plots = PlotPanel(client, self._plots_panel, layout, self._dark, actions)
            self.runs = RunsPanel(gui, self._plots.runs_tab, actions)
            self.study = StudyPanel(gui, self._plots.study_tab, self._controls, actions)
            self._plots_panel.dock_right()
            self._playback = PlaybackPanel(gui, actions)
            self._card = WheelCard(gui, actions)
            self.exports = ExportList(gui, actions)
            self._arrange_panels(layout)
        self.view = make_view(client, self._dark)
        self.view.on_pick(actions.pick_wheel)

    def _fill(self) -> None:
        """Add what is not seen at first. It is half of the page's work, and without it the rest appears sooner."""
        gui, actions = self._client.gui, self._actions
        view, out, into = self._folders
        with self._client.atomic():
            self._controls.fill()
            self._view_panel = ViewPanel(gui, view, self._dark, actions)
            with view:
                self._units_panel = UnitsPanel(gui, self._units, actions)
            self.files = FilesPanel(gui, out, into, actions)
            add_shortcuts(gui, actions)
            add_palette(gui, self._presets, actions)
            add_hints(gui)
        self._filled = True

    # ── Runs ──

    def show_run(self, done: Finished, time: float, *, settled: bool) -> None:
        """Show a finished run at `time`, s. settled: no newer request is on its way; the controls may follow."""
        self._leave_mode()
        run = done.trajectory
        self._run, self._run_number, self._drive = run, done.request.number, None
        self._name_tab(run.config)
        self._plot(time)
        self._to_view, self._drawn = run, None
        if settled:
            self._controls.show(run.config, touched=done.request.touched)
        if run.complete:
            self._notifications.forget("diverged")
        else:
            body = f"{run.status[0].upper()}{run.status[1:]}. The plots show the good part. {run.advice}"
            self._notifications.show("diverged", "The run is not complete", body, "orange", stays=True)
        self._notifications.forget("refused")

    def show_drive(self, driven: Driven, time: float, *, settled: bool) -> None:
        """Show how far the drive has come, or where in its past the user is, at `time`, s.

        The plots follow only when there is something new for them.
        """
        self._leave_mode()
        before, self._drive = self._drive, driven.state
        state = driven.state
        self._name_tab(state.config)
        if before is None or before.past is not state.past:
            self._run = state.past
            self._plot(time)
        self._to_view = None
        if not self._held:
            self.view.show_live(state.recent, state.road)
            self.view.draw(time)
            self._drawn = (self._run_number, time)
        if settled and (before is None or before.config != state.config):
            self._controls.show(state.config, touched=driven.request.touched)
        if state.ended:
            body = f"{state.ended[0].upper()}{state.ended[1:]}. {state.advice} Then press Restart."
            self._notifications.show("diverged", "The drive came to an end", body, "orange", stays=True)
        else:
            self._notifications.forget("diverged")

    def _name_tab(self, config: Config) -> None:
        title = title_html(config)
        if self._signs.title.content != title:
            self._signs.title.content = title

    def show_baseline(self, baseline: Trajectory | None) -> None:
        """Compare with this run from now on; None: with no run."""
        self._end_mode()
        self._baseline = baseline
        if self._run is not None:
            self._plot(self._plots.time)
        if not self._held:
            self.view.show_ghost(baseline)
            self._mind_the_ghost()

    def show_beside(self, beside: tuple[Beside, ...]) -> None:
        """Show these runs, too, from now on: their curves, and their vehicles as ghosts."""
        self._end_mode()
        self._beside = beside
        self._plots.show_beside(beside)
        if not self._held:
            self._view_beside(beside)

    @property
    def beside(self) -> tuple[Beside, ...]:
        """The runs that are shown, too."""
        return self._beside

    def _view_beside(self, beside: tuple[Beside, ...]) -> None:
        if beside != self._viewed_beside:
            self._viewed_beside = beside
            self.view.show_beside([(other.run, other.colour) for other in beside])

    def _mind_the_ghost(self) -> None:
        """Say once why the baseline's vehicle is not seen."""
        before, self._ghost_hidden = self._ghost_hidden, self.view.ghost_of_other_size
        if self._ghost_hidden and not before:
            self.say("The baseline is of another size", "Its vehicle is not drawn beside this one. Runs compares both.")

    def show_mode(self) -> None:
        """Show the chosen mode instead of the run, until the run plays on or another run comes."""
        mode, run = self._plots.spectrum.chosen, self._run
        if self._held:
            self._plots.spectrum.choose_run()
            self.say("One moment", "A picture or a movie is being made of the run. Show the mode when it is done.")
            return
        if mode is None or run is None or self._drive is not None or not len(run.t):
            self._end_mode()
            return
        x = float(np.interp(self._plots.time, run.t, run.q[:, run.system.chassis, 0]))
        self._mode, self._to_view = ModeShow(run.config, mode, x), None
        self.view.show(self._mode.swing)
        self.view.show_ghost(self._mode.rest)

    @property
    def shows_mode(self) -> bool:
        """Whether a mode swings in the place of the run."""
        return self._mode is not None

    def _end_mode(self) -> None:
        """Show the run again."""
        if self._mode is not None and self._run is not None:
            self._leave_mode()
            self.view.show(self._run)

    def _leave_mode(self) -> None:
        """Show the mode no longer; something else will be shown."""
        if self._mode is not None:
            self._mode, self._drawn = None, None
            self.view.show_ghost(self._baseline)
            self._plots.spectrum.choose_run()

    # ── Pictures and movies ──

    def hold_view(self, shown: InView, time: float) -> None:
        """Have the 3-D view show this, at a time, s, until `release_view`, whatever the page shows meanwhile."""
        self._leave_mode()
        self._held = True
        if shown.road is None:
            self.view.show(shown.run)
        else:
            self.view.show_live(shown.run, shown.road)
        self.view.show_ghost(shown.baseline)
        self._view_beside(shown.beside)
        self.view.draw(time)

    def film(self, time: float) -> None:
        """Show another time, s, of what is held."""
        self.view.draw(time)

    def release_view(self) -> None:
        """Let the 3-D view show what the page shows."""
        self._held, self._drawn = False, None
        self.view.show_ghost(self._baseline)
        self._view_beside(self._beside)
        if self._drive is not None:
            self.view.show_live(self._drive.recent, self._drive.road)
        else:
            self._to_view = self._run

    def redraw_spectrum(self) -> None:
        self._plots.redraw_spectrum()

    def show_presets(self, presets: Mapping[str, Config], chosen: str) -> None:
        """Offer these presets, `chosen` as the one that is used."""
        self._controls.offer(presets, chosen)

    def refuse(self, refused: Refused, instead: Config) -> None:
        """Say what is wrong with a request, and let the controls show a valid configuration instead."""
        given = refused.request.changes
        body = " ".join(refusal(fault, given.get(fault.path), instead, self._units) for fault in refused.faults)
        self._notifications.show("refused", "Not possible", body, "red")
        self._controls.show(instead)

    def refuse_text(self, text: str) -> None:
        """Say that a typed text is no value of a control that takes numbers."""
        body = f"{shorten(text)} is not understood. Give a number with at most {PRECISION} decimals."
        self._notifications.show("refused", "Not possible", body, "red")

    def report_failure(self, failed: Failed) -> None:
        self._notifications.show("refused", "No run", failed.message, "red")

    def show_status(self, under_way: tuple[int, float | None, float] | None) -> None:
        """Say which run is shown, or how far the next one has come (number, part done, seconds so far)."""
        if self._drive is not None:
            self._controls.status.content = status_line("Drive", drive_facts(self._drive))
        elif self._mode is not None:
            mode = self._mode.mode
            facts = f"{mode.frequency:.3g} Hz, shown at {1 / PERIOD:g} Hz · Play: the run"
            self._controls.status.content = status_line(mode.name, facts)
        elif under_way is not None and (under_way[2] > BUSY_DELAY or self._run is None):
            self._controls.status.content = progress_line(*under_way)
        elif self._run is not None:
            self._controls.status.content = run_line(self._run_number, self._run)

    # ── Time ──

    def draw(self, time: float, elapsed: float = 0.0) -> None:
        """The 3-D view at a time of the run, s, `elapsed` s of real time after it was drawn last.

        Of a drive that goes on, each instant is drawn as it comes. A page that is still laying out its panels gets
        nothing more yet.
        """
        if monotonic() < self._stands_at:
            return
        if not self._filled:
            self._fill()
        if self._held:
            return
        if self._to_view is not None:
            self.view.show(self._to_view)
            self._to_view = None
            self._mind_the_ghost()
        if self._mode is not None:
            if self._mode.since is None:
                self._mode.since = time
            if self._mode.since == time:
                if elapsed:
                    self.view.draw(self._mode.move_on(elapsed))
                return
            self._end_mode()
        goes_on = self._drive is not None and not self._drive.stands
        if not goes_on and self._run is not None and self._drawn != (self._run_number, time):
            self.view.draw(time)
            self._drawn = (self._run_number, time)

    def show_time(self, playback: Playback, driving: bool) -> None:
        """Player and time cursors."""
        if driving:
            self._playback.show_drive(playback, self._drive, self._units)
        else:
            self._playback.show(playback)
        if self._drive is None or self._drive.stands:
            self._plots.point_at(playback.time)
        self._plots.settle()
        self._look_as_asked()
        self.view.write_names()
        self._show_wheel()
        self._show_road(playback.time)
        if self._filled and self._run is not None:
            self._view_panel.show_load_scale(self.view.load_top, load_unit(self._run.system, self._units))

    def _show_road(self, time: float) -> None:
        """The side view of the road about the vehicle at a time of the run or drive, s.

        A new picture is work for the page, which has curves to draw meanwhile: a few times a second are enough.
        """
        now = monotonic()
        if now < self._road_due:
            return
        self._road_due = now + ROAD_EVERY
        if self._drive is not None:
            view = self._road_ahead.of_drive(self._drive.recent, self._drive.road, time, self._units)
        elif self._run is not None and len(self._run.t):
            view = self._road_ahead.of_run(self._run, time, self._units)
        else:
            return
        if self._controls.road_view.content != view:
            self._controls.road_view.content = view

    def show_speed(self, speed: float) -> None:
        """The player goes at this speed, times real time, which the user has not chosen there."""
        self._playback.follow(speed)

    # ── Parameters ──

    def mark_changes(self, request: Request) -> None:
        """Mark the parameters that a request changes in its preset."""
        if self._filled:
            self._controls.mark(request)

    def lead_to(self, key: str) -> None:
        """Lead the user to the control of a parameter."""
        parameter = PARAMETER[key]
        if self._run is not None and not parameter.applies_to(self._run.config.road.type):
            roads = " or ".join(map(choice_words, parameter.roads))
            self.say("Not on this road", f"{parameter.label} belongs to another road. Choose Road type: {roads}.")
        elif self._filled:
            self._controls.lead_to(key)

    def set_first(self, keys: Sequence[str]) -> None:
        """Have these parameters among the first sliders, besides those that always are."""
        self._controls.set_first(keys)

    def open_tab(self, tab: str) -> None:
        """Bring a tab of the plots to the front."""
        self._tabs_opened += 1
        self._opened.content = str(element("trackride-front", of=tab, count=str(self._tabs_opened)))

    # ── Looks ──

    @property
    def looks(self) -> Look:
        """How the user looks at it; the time is told elsewhere."""
        wheel, tab = self._card.wheel, self.tab_in_front
        return Look(
            self._standpoint,
            "" if wheel is None or self._run is None else wheel_names(self._run.system)[wheel],
            "" if tab == TABS[0] else tab,
            camera=self.view.turned_camera,
        )

    def look(self, config: Config, look: Look) -> None:
        """Look at it in this way, once this vehicle is shown."""
        self._to_look = config, look

    def _look_as_asked(self) -> None:
        if self._to_look is None or self._run is None or self._to_view is not None:
            return
        config, look = self._to_look
        if config != self._run.config:
            return
        self._to_look = None
        names = wheel_names(self._run.system)
        if look.view:
            self.set_view(look.view)
        if look.wheel in names and names.index(look.wheel) != self._card.wheel:
            self.pick_wheel(names.index(look.wheel))
        if look.tab and look.tab != self.tab_in_front:
            self.open_tab(look.tab)
        if look.camera:
            self._move_camera(look.camera[:3], look.camera[3:])
        if look.time is not None:
            self._actions.scrub(look.time)

    def set_view(self, view: str) -> None:
        """Look at the vehicle from a standpoint."""
        self._standpoint = view
        self.view.set_view(view)

    def set_in_front(self, tabs: frozenset[str]) -> None:
        """Take note of the tabs of the plots that are seen; from this we also know that the page is laid out."""
        self._stands_at = 0.0
        self._plots.set_in_front(tabs)

    @property
    def tab_in_front(self) -> str:
        """The first tab of the plots that is seen."""
        return next((tab for tab in TABS if tab in self._plots.in_front), TABS[0])

    @property
    def runs_in_front(self) -> bool:
        """Whether the tab of the runs is seen."""
        return RUNS in self._plots.in_front

    @property
    def study_in_front(self) -> bool:
        """Whether the tab of studies is seen."""
        return STUDY in self._plots.in_front

    def follow(self, key: str, value: Any) -> None:
        """Let the control of a parameter show a value that the user has set elsewhere."""
        self._controls[key].show(value)

    def set_page_size(self, width: int, height: int, view: int) -> None:
        """Share a page of this size among the panels; view: width of the 3-D view as it is, px."""
        if (width, height) != (self._layout.width, self._layout.height):
            self._arrange(page_layout(width, height, large=self._large))
        elif self._layout.plots == "beside":  # the user has moved a seam: only what stands in the view follows
            self._float(page_layout(width, height, view))

    def enlarge_plots(self) -> None:
        """Let the plots stand over the view, or put them back."""
        self._large = not self._large
        self._arrange(page_layout(self._layout.width, self._layout.height, large=self._large))

    def set_dark(self, dark: bool) -> None:
        self._dark = dark
        if self._filled:
            self._view_panel.show_dark(dark)
        apply_theme(self._client.gui, dark)
        self._plots.set_dark(dark)
        self.view.set_dark(dark)

    def pick_wheel(self, wheel: int | None) -> None:
        """Show the card of a wheel and fade the other curves; None, or the wheel that is picked already: no card."""
        self._plots.single_out(self._card.pick(wheel))
        self.view.mark_wheel(self._card.wheel)
        self._show_wheel()

    def _show_wheel(self) -> None:
        if self._held:
            return
        wheel = self._card.wheel
        state = self.view.wheel_state(wheel) if wheel is not None else None
        if wheel is not None and state is not None and self._run is not None:
            palette = wheel_palette(self._run.system.n, self._run.system.m, self._dark)
            self._card.show(state, palette.wheels[wheel], load_unit(self._run.system, self._units), self._units)
        elif wheel is not None:
            self.pick_wheel(None)

    def set_switch(self, switch: str, on: bool) -> None:
        """Turn something of the 3-D view on or off."""
        self.view.set_switch(switch, on)
        self._drawn = None

    def set_arrow_scale(self, scale: float) -> None:
        """Make the force arrows longer or shorter."""
        self.view.set_arrow_scale(scale)
        self._drawn = None

    def toggle_switch(self, switch: str) -> None:
        """Turn a switch of the 3-D view, and its checkbox, on if it is off, and off if it is on."""
        self.set_switch(switch, self._view_panel.toggle(switch))

    def show_surroundings(self, on: bool) -> None:
        """Sky and ground."""
        self.view.show_surroundings(on)

    def set_units(self, units: Units) -> None:
        """Tell all quantities in these units."""
        self._units = units
        with self._client.atomic():
            self._controls.set_units(units)
            if self._filled:
                self._units_panel.show(units)
            self._plots.set_units(units)
            self.study.set_units(units)
            self.view.set_units(units)
            self._show_wheel()

    @property
    def units(self) -> Units:
        return self._units

    @property
    def dark(self) -> bool:
        return self._dark

    @property
    def background(self) -> str:
        """Colour behind the vehicle in pictures."""
        return "#1a1b1e" if self._dark else "#ffffff"

    def report_error(self, error: Exception) -> None:
        text = str(error) or type(error).__name__
        self._notifications.show("error", "Something went wrong", f"{text} (details are in the terminal).", "red")

    def say(self, title: str, body: str) -> None:
        self._notifications.show("said", title, body, "blue")

    def show_faults(self, title: str, faults: ConfigError, text: str | None = None) -> None:
        """Show all that is wrong with a configuration from outside; text: its own, which the user may mend."""
        show_faults(self._client.gui, title, faults, self._actions, text)

    def ask(self, title: str, words: str, yes: str, act: Callable[[], None]) -> None:
        """Have the user say yes or no; act: called on the event loop at a yes."""
        ask(self._client.gui, title, words, yes, act, self._actions)

    def ask_about_profile(self, question: ProfileQuestion) -> None:
        """Ask how the file of a profile is to be read."""
        ProfileForm(self._client.gui, question, self._actions)

    def edit_yaml(self, text: str, faults: ConfigError | None = None) -> None:
        """Open the text of a configuration, and lead to its faults."""
        YamlWindow(self._client.gui, text, self._actions, faults)

    def store(self, state: str) -> None:
        """Have the tab store a text until its page is loaded anew."""
        store_visit(self._signs, state)

    def place(self, playback: Playback) -> Place:
        """Where we are, and where the camera stands."""
        camera = self._client.camera
        position, look_at = (tuple(np.round(point, 3).tolist()) for point in (camera.position, camera.look_at))
        return Place(round(playback.time, 3), playback.playing, position, look_at)

    def store_place(self, place: str) -> None:
        """Have the tab store a text until its page is loaded anew."""
        store_place(self._signs, place)

    def look_from(self, place: Place) -> None:
        """Move the camera there."""
        self._move_camera(place.position, place.look_at)

    def _move_camera(self, position: Sequence[float], look_at: Sequence[float]) -> None:
        camera = self._client.camera
        with self._client.atomic():
            camera.position = np.array(position)
            camera.look_at = np.array(look_at)

    @property
    def shows_run(self) -> bool:
        """Whether the 3-D view shows a run by now."""
        return self._drawn is not None

    def _arrange(self, layout: PageLayout) -> None:
        with self._client.atomic():
            self._arrange_panels(layout)
        self.view.fit_page(layout.height - layout.below, covered(layout), layout.scale)

    def _arrange_panels(self, layout: PageLayout) -> None:
        self._layout = layout
        self._signs.layout.content = layout_html(layout)
        self._client.gui.main_panel.set_width(layout.left)
        self._plots_panel.set_width(layout.docked)
        self._plots.arrange(layout)
        self._float(layout)

    def _float(self, layout: PageLayout) -> None:
        self._playback.place(layout)
        self._card.place(layout)
        self.exports.place(layout)

    def _plot(self, time: float) -> None:
        assert self._run is not None
        drive = self._drive
        road = drive.road if drive is not None and drive.stands else None
        self._plots.show(self._run, self._baseline, time, driving=drive is not None, road=road)
