"""Everything that panels and keys may ask for. The session carries it out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from app.runs.study_choice import StudyChoice
from model.config.config import Config, ConfigError
from model.config.profile_files import ProfileFile, Reading


class Actions(Protocol):
    """app.session.session.Session, or a stand-in. No method blocks: viser's event loop calls them."""

    # Parameters and road

    def change(self, key: str, value: Any) -> None:
        """Give a parameter another value, as in a file. The user may still be moving its control."""

    def enter(self, key: str, value: Any) -> None:
        """Give a parameter a value that was typed as text: it is there as a whole, and its control may follow."""

    def refuse_text(self, text: str) -> None:
        """Say that a typed text is no value."""

    def load(self, preset: str) -> None:
        """Take a preset, by its name."""

    def reset(self) -> None:
        """Go back to the preset without any change."""

    def reset_one(self, key: str) -> None:
        """Give a parameter the value of the preset."""

    def lead_to(self, key: str) -> None:
        """Lead the user to the control of a parameter."""

    def set_first(self, keys: Sequence[str]) -> None:
        """Have these parameters among the first sliders, besides those that always are."""

    def undo(self) -> None: ...

    def redo(self) -> None: ...

    def add_to_road(self, road_type: str) -> None:
        """Add a part of this type to the road."""

    def take_from_road(self) -> None:
        """Take the last part of the road away."""

    def upload_profile(self, name: str, content: bytes) -> None:
        """Make the road of a file, or ask how it is to be read where it does not say so itself."""

    def ask_about_profile(self) -> None:
        """Ask how the file of the present profile is to be read."""

    def look_at_profile(self, show: Callable[[], None]) -> None:
        """Have a window show a file as it is to be read now. It may take its time: it runs later."""

    def use_profile(self, read: Callable[[], tuple[str, ProfileFile, Reading] | None]) -> None:
        """Make the road of what `read` gives, if it gives something: a file's name, what was read of it, and how."""

    # Configurations

    def upload_configuration(self, name: str, content: bytes) -> None:
        """Take the configuration in a YAML file."""

    def edit_yaml(self) -> None:
        """Open the present configuration as text."""

    def mend_yaml(self, text: str, error: ConfigError) -> None:
        """Open a text that is no configuration, for its faults to be mended."""

    def use_configuration(self, read: Callable[[], Config | None]) -> None:
        """Take the configuration that `read` gives, if it gives one. It may take its time: it runs later."""

    def save_preset(self, name: str) -> None:
        """Make a preset of the configuration that is shown."""

    def open_link(self, text: str) -> None:
        """Show what the fragment of an address says (app/format/link.py)."""

    def copy_link(self) -> None:
        """Give the user an address that shows the same in anybody's explorer."""

    # Runs and baseline

    def pin(self) -> None:
        """Make the run that is shown the baseline."""

    def swap(self) -> None:
        """Show the baseline, and make what is shown now the baseline."""

    def clear_baseline(self) -> None:
        """Compare with no run."""

    def upload_run(self, name: str, content: bytes) -> None:
        """Make the run in an NPZ file the baseline."""

    def upload_project(self, name: str, content: bytes) -> None:
        """Open a project, after a question where that would lose something."""

    def rename(self, name: str) -> None:
        """Name the run that is shown, and keep it."""

    def recall(self, number: int) -> None:
        """Show a kept run."""

    def compare(self, number: int) -> None:
        """Make a kept run the baseline."""

    def tick_run(self, number: int) -> None:
        """Show a kept run beside the one that is shown, or do so no more."""

    def delete(self, number: int) -> None:
        """Keep a run no more."""

    # Playback and drive

    def toggle(self) -> None:
        """Play, or pause."""

    def step(self, steps: int) -> None:
        """Go some steps on, or back when negative, and pause."""

    def scrub(self, time: float) -> None:
        """Go to a time, s, and pause."""

    def set_speed(self, speed: float) -> None:
        """Play or drive at so many times real time."""

    def set_driving(self, on: bool) -> None:
        """Drive on and on with the present parameters, or show their run."""

    def toggle_driving(self) -> None: ...

    def restart_drive(self) -> None:
        """Drive from rest."""

    # Looks

    def set_view(self, view: str) -> None:
        """Look at the vehicle from another standpoint (app/view3d/camera.py)."""

    def set_switch(self, switch: str, on: bool) -> None:
        """Turn something of the 3-D view on or off (app/view3d/overlays.py)."""

    def toggle_switch(self, switch: str) -> None: ...

    def set_arrow_scale(self, scale: float) -> None:
        """Make the force arrows longer or shorter."""

    def pick_wheel(self, wheel: int | None) -> None:
        """Show a wheel's card; None, or the wheel that is picked already: no card."""

    def open_tab(self, tab: str) -> None:
        """Bring a tab of the plots to the front."""

    def set_dark(self, dark: bool) -> None:
        """Choose the look of the page."""

    def choose_units(self, chosen: Mapping[str, str]) -> None:
        """Tell some quantities in other units: names in app.format.units.CHOICES, and one of both units of each."""

    def enlarge_plots(self) -> None:
        """Let the plots stand over the view, or put them back."""

    # Spectrum

    def redraw_spectrum(self) -> None:
        """Show the spectrum that the tab's boxes say."""

    def show_mode(self) -> None:
        """Show the mode that the tab's box says instead of the run."""

    # Study

    def choose_study(self, choice: StudyChoice) -> None:
        """Show this in the tab "Study" and on the sliders."""

    def take_record(self, name: str, text: str) -> None:
        """Compare runs with a measured acceleration: the text of a CSV file."""

    def steer(self, key: str, value: Any) -> None:
        """Give a parameter another value, as in a file, and let its control follow: the user moves it elsewhere."""

    # First steps

    def start_tour(self) -> None:
        """Show the tour of the page from its first step."""

    def try_example(self, name: str) -> None:
        """Do an example (app/runs/examples.py) in the page."""

    def undo_example(self) -> None:
        """Go back to what was shown before the example."""

    def keep_example(self) -> None:
        """Leave everything as the example has made it, and put its card away."""

    # Downloads

    def export(self, what: str) -> None:
        """Make a file and let the browser download it; what: a key of app.session.downloads.Downloads."""

    def cancel_export(self, number: int) -> None:
        """Make the file of this number (app/panels/export_list.py) no more."""

    # What the page itself tells

    def set_in_view(self, in_view: bool) -> None:
        """A page in the background stands still."""

    def set_page_size(self, width: int, height: int, view: int) -> None:
        """The page, and its 3-D view, have this width and height, and this width, px."""

    def set_in_front(self, tabs: frozenset[str]) -> None:
        """Only the tabs that are seen keep up with a drag."""

    def return_to(self, place: str) -> None:
        """The tab was at this place (app/runs/storage.py) when its page was loaded anew."""

    def recollect(self, visit: str) -> None:
        """Go on where the tab was before its page was loaded anew: `visit` is what it has stored.

        "null": a new tab, which goes on where the browser was last.
        """

    def prefer_dark(self, dark: bool) -> None:
        """The browser is set to this look."""

    # Errors

    def fail(self, error: Exception) -> None:
        """Log an error and tell the user."""
