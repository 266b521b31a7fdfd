"""`make film`: the film at the README's top, taken in a real browser.

Without graphics hardware a page takes longer to draw than a frame of the film lasts. So the mouse and the run go on by
one frame at a time, and each frame is taken once the page shows the run that belongs to it; in between it draws nothing
in 3-D, which would hold up the curves.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from itertools import count
from typing import NamedTuple

from PIL import Image, ImageDraw
from playwright.sync_api import ViewportSize

from tests.browser.driver import DRAWING, Explorer, chromium, running_explorer
from tests.browser.pictures import PICTURES

SIZE: ViewportSize = {"width": 1280, "height": 720}
WIDTH, HEIGHT = 960, 540  # px, of the film
RATE = 10  # frames/s
START = 0.5  # s of the run
COLOURS = 56  # more would make the film larger than 4 MB
SETTLES = 0.2  # s in which a page takes in a run and its time
ARROW = (0, 0), (0, 17), (4, 13.5), (6.6, 19.5), (9.2, 18.3), (6.6, 12.6), (12, 12.2)  # px
TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
SHOW_TIME = "([time, k]) => trackrideTell('at', JSON.stringify([time, k]))"  # as a click in a plot does
THUMB = """thumb => {
  const box = thumb.getBoundingClientRect(), track = thumb.parentElement.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2, track.left, track.width,
    Number(thumb.ariaValueMin), Number(thumb.ariaValueMax)];
}"""


class Leg(NamedTuple):
    """A way of the mouse to the handle of a slider, and on with it to other values."""

    label: str
    way: float  # s to the handle
    values: tuple[tuple[float, float], ...]  # where the handle is dragged, and in how many s


LEGS = (
    Leg("Speed", 1.0, ((24.0, 2.2), (18.0, 1.4))),
    Leg("Amplitude", 0.9, ((40.0, 1.8), (100.0, 1.4))),
)


def smooth(part: float) -> float:
    """0…1, starting and ending slowly."""
    return part * part * (3 - 2 * part)


def moved(begin: tuple[float, float], end: tuple[float, float], seconds: float) -> Iterator[tuple[float, float]]:
    """Where the mouse is in each frame."""
    frames = round(seconds * RATE)
    for frame in range(1, frames + 1):
        part = smooth(frame / frames)
        yield begin[0] + part * (end[0] - begin[0]), begin[1] + part * (end[1] - begin[1])


class Camera:
    """Takes the frames."""

    def __init__(self, explorer: Explorer) -> None:
        self._explorer, self._page = explorer, explorer.page
        self._at = 560.0, 430.0  # px, of the mouse
        self._frames: list[Image.Image] = []
        self._numbers = count(1)

    def follow(self, leg: Leg) -> None:
        """Go to the handle of a slider, and drag it."""
        thumb = self._explorer.thumb(leg.label)
        x, y, left, width, low, high = thumb.evaluate(THUMB)
        for at in moved(self._at, (x, y), leg.way):
            self._take(at)
        self._page.mouse.down()
        for value, seconds in leg.values:
            for at in moved(self._at, (left + width * (value - low) / (high - low), y), seconds):
                before, number = self._explorer.value(leg.label), self._explorer.run_number()
                self._page.mouse.move(*at)
                self._page.wait_for_timeout(60)
                if self._explorer.value(leg.label) != before:
                    self._explorer.wait_for_run(after=number)
                self._take(at)
        self._page.mouse.up()

    def _take(self, at: tuple[float, float]) -> None:
        """A frame with the mouse there, a tenth of a second of the run on."""
        self._at = at
        self._page.mouse.move(*at)
        number = next(self._numbers)
        self._page.evaluate(SHOW_TIME, [START + number / RATE, number])
        self._page.wait_for_timeout(1000 * SETTLES)
        with self._explorer.drawing():
            self._page.evaluate(TWO_FRAMES)
            picture = self._page.screenshot()
        frame = Image.open(io.BytesIO(picture)).convert("RGB")
        arrow = [(at[0] + x, at[1] + y) for x, y in ARROW]
        ImageDraw.Draw(frame).polygon(arrow, fill="#111", outline="#fff", width=1)
        self._frames.append(frame.resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS))

    def save(self) -> None:
        """All frames, in the same colours, so that what stands still costs nothing."""
        some = self._frames[:: max(len(self._frames) // 8, 1)]
        sheet = Image.new("RGB", (WIDTH, HEIGHT * len(some)))
        for row, frame in enumerate(some):
            sheet.paste(frame, (0, HEIGHT * row))
        palette = sheet.quantize(COLOURS, Image.Quantize.FASTOCTREE)
        first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in self._frames)
        first.save(
            PICTURES / "drag.gif", save_all=True, append_images=others, duration=1000 // RATE, loop=0, optimize=False
        )


def main() -> None:
    with running_explorer() as address, chromium() as browser:
        page = browser.new_page(viewport=SIZE)
        page.add_init_script(DRAWING)
        explorer = Explorer(page).open(address)
        explorer.come_to_rest()
        camera = Camera(explorer)
        for leg in LEGS:
            camera.follow(leg)
        camera.save()


if __name__ == "__main__":
    main()
