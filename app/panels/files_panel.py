"""Folders for what goes out of the explorer and what comes in: pictures, files, configurations, presets."""

from __future__ import annotations

import html
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import viser

from app.files.pictures import MOVIE_LENGTH, MOVIE_RATE, SIZES
from app.files.uploads import configuration
from app.panels.callbacks import by_user
from model.config.config import Config, ConfigError, dump_config

if TYPE_CHECKING:
    from app.session.workspace import Desk

PICTURE = "picture"
FIGURES = {"PNG": "figure.png", "SVG": "figure.svg"}  # shown -> what is exported
DATA = {"CSV": "run.csv", "NPZ": "run.npz", "YAML": "yaml"}
MOVING = {"Replay": "replay", "Movie": "movie"}
CANCEL = "Cancel"
SAVE, EDIT = "Save preset", "Edit YAML"
STYLE = f"<style>{(Path(__file__).parents[2] / 'assets' / 'modal.css').read_text()}</style>"  # in each window's HTML


class Exporter(Protocol):
    """What the panel asks of the session."""

    def ask(self, kind: str, act: Callable[[Desk], None]) -> None: ...

    def export(self, what: str) -> None: ...

    def cancel_export(self) -> None: ...

    def upload_configuration(self, name: str, content: bytes) -> None: ...

    def upload_run(self, name: str, content: bytes) -> None: ...

    def edit_yaml(self) -> None: ...

    def fail(self, error: Exception) -> None: ...


class ExportsPanel:
    """Fills two folders of `gui`."""

    def __init__(
        self, gui: viser.GuiApi, out: viser.GuiFolderHandle, into: viser.GuiFolderHandle, exporter: Exporter
    ) -> None:
        self._gui, self._exporter = gui, exporter
        fail = exporter.fail
        with out:
            self._size = gui.add_dropdown("Picture size", tuple(SIZES), hint="Of screenshots: pixels, width × height")
            self._transparent = gui.add_checkbox(
                "Transparent", False, hint="Screenshots show vehicle and road without sky and ground"
            )
            picture = gui.add_button("Screenshot", hint="The 3-D view as a PNG file (S)", icon=viser.Icon.CAMERA)
            figure = gui.add_button_group(
                "Figure",
                tuple(FIGURES),
                hint="One page to take home: the 3-D view, the plots with their baseline, all figures and parameters",
            )
            data = gui.add_button_group(
                "Data",
                tuple(DATA),
                hint="CSV: motion and loads as a table. NPZ: the whole run, which Import takes back as a baseline. "
                "YAML: the configuration, to be imported or run from the command line.",
            )
            moving = gui.add_button_group(
                "In motion",
                (*MOVING, CANCEL),
                hint="Replay: the run as one HTML file that plays in any browser, in a few seconds. Movie: "
                f"{MOVIE_LENGTH:g} s of the 3-D view from the present time on. The page draws each of its "
                f"{MOVIE_LENGTH * MOVIE_RATE:.0f} frames anew and must stay in front: without a graphics card that can "
                "take three minutes. Cancel: stop making either.",
            )
        with into:
            self._name = gui.add_text("Preset name", "", hint="A name for the present parameters")
            present = gui.add_button_group(
                "As they are",
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
        picture.on_click(by_user(lambda event: exporter.export(PICTURE), fail))
        for group, files in ((figure, FIGURES), (data, DATA), (moving, MOVING)):
            group.on_click(by_user(_exporting(exporter, files), fail))
        acts = {SAVE: self._save, EDIT: exporter.edit_yaml}
        present.on_click(by_user(lambda event: acts[event.target.value](), fail))
        config.on_upload(
            by_user(lambda event: exporter.upload_configuration(config.value.name, config.value.content), fail)
        )
        run.on_upload(by_user(lambda event: exporter.upload_run(run.value.name, run.value.content), fail))

    @property
    def size(self) -> tuple[int, int]:
        """Of pictures, px."""
        return SIZES[self._size.value]

    @property
    def transparent(self) -> bool:
        return self._transparent.value

    def edit_yaml(self, config: Config) -> None:
        """Open the configuration as text in a window of its own."""
        with self._gui.add_modal("Configuration") as modal:
            self._gui.add_html(f'<div class="trackride-yaml"></div>{STYLE}')
            text: Any = self._gui.add_text("YAML", dump_config(config), multiline=True)
            faults = self._gui.add_html("")
            use = self._gui.add_button("Use this", hint="Run it; Undo leads back")
            close = self._gui.add_button("Close", color="gray")

        def run_it(desk: Desk) -> None:
            try:
                wished = configuration("", text.value.encode())
            except ConfigError as error:
                faults.content = fault_list(error)
            else:
                modal.close()
                desk.use(wished)

        use.on_click(by_user(lambda event: self._exporter.ask("configuration", run_it), self._exporter.fail))
        close.on_click(by_user(lambda event: modal.close(), self._exporter.fail))

    def show_faults(self, title: str, error: ConfigError) -> None:
        """Say all that is wrong with a configuration, in a window of its own."""
        with self._gui.add_modal(title) as modal:
            self._gui.add_html(fault_list(error) + STYLE)
            close = self._gui.add_button("Close")
        close.on_click(by_user(lambda event: modal.close(), self._exporter.fail))

    def _save(self) -> None:
        name = self._name.value
        self._exporter.ask("preset", lambda desk: desk.save_preset(name))


def fault_list(error: ConfigError) -> str:
    """All faults as HTML."""
    items = "".join(f"<li>{html.escape(str(fault))}</li>" for fault in error.faults)
    return f'<ul class="trackride-faults">{items}</ul>'


def _exporting(exporter: Exporter, files: dict[str, str]) -> Callable[[Any], None]:
    def act(event: Any) -> None:
        if event.target.value == CANCEL:
            exporter.cancel_export()
        else:
            exporter.export(files[event.target.value])

    return act
