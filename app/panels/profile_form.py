"""A window that asks how the file of a profile is to be read: columns and units, with a picture of what comes of it."""

from __future__ import annotations

from typing import Any

import viser

from app.files.uploads import ProfileQuestion
from app.format.assets import asset
from app.format.markup import element, joined, style
from app.panels.actions import Actions
from app.panels.callbacks import by_user
from app.tabs.profile_preview import profile_preview
from model.config.parameters import UNITS
from model.config.profile_files import ProfileFile, Reading
from model.config.profile_points import PointsError

LISTED = 200  # columns at most that are offered


class ProfileForm:
    """What is likely is chosen at first. Nothing is used before the user says so."""

    def __init__(self, gui: viser.GuiApi, question: ProfileQuestion, actions: Actions) -> None:
        self._question = question
        source, likely = question.source, question.reading
        self._columns = dict(zip(source.labels[:LISTED], source.columns[:LISTED], strict=True))  # label -> name
        labels = {name: label for label, name in self._columns.items()}
        why = question.why.partition("; ")[0]  # what comes then is advice for those who write files
        why = f"{why[:1].upper()}{why[1:]}. What is chosen below is likely: change what is wrong." if why else ""
        with gui.add_modal(f"How to read {question.name[:60]}") as self._modal:
            # The window gives the keys to these words: a box for choice would open its list at once
            words = element("p", why, class_="trackride-why", tabindex="-1", data_autofocus="")
            gui.add_html(str(joined((words, style(asset("modal.css"))))))
            self._chosen: list[Any] = []
            self._units: list[Any] = []
            names = likely.columns if source.x_is_column else (None, *likely.columns)
            for what, name, unit in zip(("Distance", "Height"), names, likely.units, strict=True):
                of = what.lower()
                if name is not None:
                    hint = f"The column of the file that holds the {of}"
                    box = gui.add_dropdown(
                        f"{what} column", tuple(self._columns), initial_value=labels.get(name), hint=hint
                    )
                    self._chosen.append(box)
                hint = f"The unit in which the file gives the {of}"
                self._units.append(gui.add_dropdown(f"{what} unit", tuple(UNITS), initial_value=unit, hint=hint))
            self._preview = gui.add_html("")
            self._use = gui.add_button("Use", hint="Make it the road; Undo leads back")
            cancel = gui.add_button("Cancel", color="gray", hint="Leave the road as it is")
        for box in (*self._chosen, *self._units):
            box.on_update(by_user(lambda event: actions.look_at_profile(self.show), actions.fail))
        self._use.on_click(by_user(lambda event: actions.use_profile(self.read), actions.fail))
        cancel.on_click(by_user(lambda event: self._modal.close(), actions.fail))
        self.show()

    @property
    def _reading(self) -> Reading:
        columns = tuple(self._columns[box.value] for box in self._chosen)
        return Reading(columns, tuple(box.value for box in self._units))

    def show(self) -> None:
        """Show the profile as the boxes say, or why it cannot be read so."""
        reading = self._reading
        try:
            file = self._question.source.read(reading.columns, reading.units)
        except PointsError as error:
            shown = element("p", f"So it cannot be used: {error}.", class_="trackride-refused")
            self._use.disabled = True
        else:
            shown = joined((profile_preview(file.x, file.y), element("p", f"{file.said}.", class_="trackride-said")))
            self._use.disabled = False
        self._preview.content = str(shown)

    def read(self) -> tuple[str, ProfileFile, Reading] | None:
        """The file's name and what the boxes say, and the window closes; None where it cannot be read so."""
        reading = self._reading
        try:
            file = self._question.source.read(reading.columns, reading.units)
        except PointsError:
            return None
        self._modal.close()
        return self._question.name, file, reading
