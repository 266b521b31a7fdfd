"""The folders for downloads and uploads: pictures, files, configurations, presets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from app.files.movie_frames import FROM_START, LENGTHS, RATE, MovieChoice
from app.files.pictures import SIZES
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.runs.project import SUFFIX
from model.analysis.channels import CHANNELS, USUAL

PICTURE = "picture"
FIGURE_BUTTONS = {"PNG": "figure.png", "SVG": "figure.svg", "Report": "report"}  # shown -> what is exported
DATA_BUTTONS = {"CSV": "run.csv", "NPZ": "run.npz", "YAML": "yaml"}
PROJECT = "project"
MOTION_BUTTONS = {"Replay": "replay", "Movie": "movie"}
SAVE, EDIT = "Save preset", "Edit YAML"


class FilesPanel:
    """Fills two folders of `gui`."""

    def __init__(
        self, gui: viser.GuiApi, out: viser.GuiFolderHandle, into: viser.GuiFolderHandle, actions: Actions
    ) -> None:
        fail = actions.fail
        with out:
            link = gui.add_button(
                "Copy link",
                hint="An address that opens this vehicle, road, baseline and view in anybody's explorer",
                icon=viser.Icon.LINK,
            )
            self._size = gui.add_dropdown(
                "Picture size", tuple(SIZES), hint="Of screenshots and movies: pixels, width × height"
            )
            self._transparent = gui.add_checkbox(
                "Transparent", False, hint="Screenshots show vehicle and road without sky and ground"
            )
            picture = gui.add_button("Screenshot", hint="The 3-D view as a PNG file (S)", icon=viser.Icon.CAMERA)
            figure = gui.add_button_group(
                "Figure",
                tuple(FIGURE_BUTTONS),
                hint="PNG, SVG: one page to take home, with 3-D view, plots, figures and parameters. Report: all of it "
                "at length as one HTML file. Both compare with the baseline.",
            )
            data = gui.add_button_group(
                "Data",
                tuple(DATA_BUTTONS),
                hint="CSV: a table, with the columns that are ticked below. NPZ: the whole run, which Import takes "
                "back as a baseline. YAML: the configuration, to be imported or run from the command line.",
            )
            with gui.add_folder("Columns of the CSV", expand_by_default=False):
                self._channels: dict[str, Any] = {
                    name: gui.add_checkbox(channel.label, name in USUAL, hint=channel.what)
                    for name, channel in CHANNELS.items()
                }
            moving = gui.add_button_group(
                "In motion",
                tuple(MOTION_BUTTONS),
                hint="Replay: the run as one HTML file that plays in any browser, in a few seconds. Movie: of the 3-D "
                f"view. The page draws each of its {RATE:g} frames a second anew and must stay in front: without a "
                "graphics card a second of the movie can take a minute.",
            )
            self._length = gui.add_dropdown("Movie length", tuple(LENGTHS), hint="Of the run that is filmed, at most")
            self._start = gui.add_dropdown(
                "Movie from", tuple(FROM_START), hint="Where in the run the movie begins: at the time shown, or at 0 s"
            )
            self._stamped = gui.add_checkbox(
                "Time stamp", False, hint="Movies say time, vehicle and speed in their lower left corner"
            )
            project = gui.add_button(
                "Save project",
                hint="One file for all that is here: kept runs with their names, baseline, your presets, what is shown "
                "and the choices of the Study tab. Import opens it again.",
            )
        with into:
            name: Any = gui.add_text("Preset name", "", hint="A name for the present parameters")
            present = gui.add_button_group(
                "Present values",
                (SAVE, EDIT),
                hint="The present parameters. Save preset: into the list of presets, under the name above; this "
                "browser remembers it. Edit YAML: all of them as text, to copy, change or paste.",
            )
            config = gui.add_upload_button(
                "Open a configuration",
                mime_type=".yaml,.yml",
                hint="A YAML file, such as Data saves: all parameters follow",
            )
            run = gui.add_upload_button(
                "Open a run as baseline",
                mime_type=".npz",
                hint="An NPZ file, such as Data saves: it is compared with what is shown",
            )
            opened = gui.add_upload_button(
                "Open a project",
                mime_type=SUFFIX,
                hint="A file that Save project has made: it takes the place of runs, baseline and parameters",
            )
        link.on_click(by_user(lambda event: actions.copy_link(), fail))
        picture.on_click(by_user(lambda event: actions.export(PICTURE), fail))
        for group, buttons in ((figure, FIGURE_BUTTONS), (data, DATA_BUTTONS), (moving, MOTION_BUTTONS)):
            group.on_click(by_user(_exporting(actions, buttons), fail))
        acts = {SAVE: lambda: actions.save_preset(name.value), EDIT: actions.edit_yaml}
        present.on_click(by_user(lambda event: acts[event.target.value](), fail))
        config.on_upload(
            by_user(lambda event: actions.upload_configuration(config.value.name, config.value.content), fail)
        )
        project.on_click(by_user(lambda event: actions.export(PROJECT), fail))
        opened.on_upload(by_user(lambda event: actions.upload_project(opened.value.name, opened.value.content), fail))
        run.on_upload(by_user(lambda event: actions.upload_run(run.value.name, run.value.content), fail))

    @property
    def size(self) -> tuple[int, int]:
        """Of pictures and movies, px."""
        return SIZES[self._size.value]

    @property
    def transparent(self) -> bool:
        return self._transparent.value

    @property
    def channels(self) -> tuple[str, ...]:
        """Columns of a CSV file, beside the time."""
        return tuple(name for name, box in self._channels.items() if box.value)

    @property
    def movie(self) -> MovieChoice:
        """What is filmed."""
        return MovieChoice(LENGTHS[self._length.value], FROM_START[self._start.value], self._stamped.value)


def _exporting(actions: Actions, buttons: dict[str, str]) -> Callable[[Any], None]:
    def act(event: Any) -> None:
        actions.export(buttons[event.target.value])

    return act
