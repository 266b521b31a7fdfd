"""The folders for downloads and uploads: pictures, files, configurations, presets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from app.files.pictures import MOVIE_LENGTH, MOVIE_RATE, SIZES
from app.panels.actions import Actions
from app.panels.callbacks import by_user

PICTURE = "picture"
FIGURE_BUTTONS = {"PNG": "figure.png", "SVG": "figure.svg"}  # shown -> what is exported
DATA_BUTTONS = {"CSV": "run.csv", "NPZ": "run.npz", "YAML": "yaml"}
MOTION_BUTTONS = {"Replay": "replay", "Movie": "movie"}
CANCEL = "Cancel"
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
            self._size = gui.add_dropdown("Picture size", tuple(SIZES), hint="Of screenshots: pixels, width × height")
            self._transparent = gui.add_checkbox(
                "Transparent", False, hint="Screenshots show vehicle and road without sky and ground"
            )
            picture = gui.add_button("Screenshot", hint="The 3-D view as a PNG file (S)", icon=viser.Icon.CAMERA)
            figure = gui.add_button_group(
                "Figure",
                tuple(FIGURE_BUTTONS),
                hint="One page to take home: the 3-D view, the plots with their baseline, all figures and parameters",
            )
            data = gui.add_button_group(
                "Data",
                tuple(DATA_BUTTONS),
                hint="CSV: motion and loads as a table. NPZ: the whole run, which Import takes back as a baseline. "
                "YAML: the configuration, to be imported or run from the command line.",
            )
            moving = gui.add_button_group(
                "In motion",
                (*MOTION_BUTTONS, CANCEL),
                hint="Replay: the run as one HTML file that plays in any browser, in a few seconds. Movie: "
                f"{MOVIE_LENGTH:g} s of the 3-D view from the present time on. The page draws each of its "
                f"{MOVIE_LENGTH * MOVIE_RATE:.0f} frames anew and must stay in front: without a graphics card that can "
                "take three minutes. Cancel: stop making either.",
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
        link.on_click(by_user(lambda event: actions.copy_link(), fail))
        picture.on_click(by_user(lambda event: actions.export(PICTURE), fail))
        for group, buttons in ((figure, FIGURE_BUTTONS), (data, DATA_BUTTONS), (moving, MOTION_BUTTONS)):
            group.on_click(by_user(_exporting(actions, buttons), fail))
        acts = {SAVE: lambda: actions.save_preset(name.value), EDIT: actions.edit_yaml}
        present.on_click(by_user(lambda event: acts[event.target.value](), fail))
        config.on_upload(
            by_user(lambda event: actions.upload_configuration(config.value.name, config.value.content), fail)
        )
        run.on_upload(by_user(lambda event: actions.upload_run(run.value.name, run.value.content), fail))

    @property
    def size(self) -> tuple[int, int]:
        """Of pictures, px."""
        return SIZES[self._size.value]

    @property
    def transparent(self) -> bool:
        return self._transparent.value


def _exporting(actions: Actions, buttons: dict[str, str]) -> Callable[[Any], None]:
    def act(event: Any) -> None:
        if event.target.value == CANCEL:
            actions.cancel_export()
        else:
            actions.export(buttons[event.target.value])

    return act
