"""From a key press on a slider to the new run's curve on the page: a real browser, a drag-like row of presses.

GL cost aside: where there is no graphics processor, drawing in 3-D and putting the page together with GL take most of
both cores, so here the 3-D view is left empty and the page is put together without GL. Each run carries the slider's
value as the first load of R1, so that the page can tell which run it draws.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median, quantiles
from typing import Any

import numpy as np
import viser

from app.runs.request import Finished
from app.server import Explorer as Server
from app.session.session import Session
from app.session.window import Window
from app.view3d.view import View3D
from model import load_config, simulate
from model.config.config import Config
from model.simulation.trajectory import Trajectory
from tests.browser.driver import Explorer, chromium

PRESSES = 60
BETWEEN = 60.0  # ms: about as often as a key repeats or a dragged slider sends
MARKED = 20  # samples that carry the mark
STEP = 0.5  # km/h, of the slider
PARTS = ("browser → callback", "waiting for the run before", "simulation", "publishing", "page")

WATCH = """() => {
  window.pressed = []; window.drawn = [];
  const now = () => performance.timeOrigin + performance.now();
  document.addEventListener('keydown', () => window.pressed.push(now()), true);
  const chart = Object.values(__viserTestpoints.uplots).map((entry) => entry.chart)
    .find((chart) => chart.series[1].label === 'R1');
  (chart.hooks.draw ??= []).push(() => window.drawn.push([chart.data[1][0], now()]));
}"""


class EmptyView(View3D):
    """A 3-D view without vehicle and road."""

    def show(self, trajectory: Trajectory) -> None: ...

    def draw(self, time: float) -> None: ...


Times = dict[float, float]  # the slider's value, km/h -> when something was first done with it, ms


class Watch:
    """When the server did what, by the slider's value."""

    def __init__(self) -> None:
        self.called: Times = {}
        self.begun: Times = {}
        self.done: Times = {}
        self.published: Times = {}

    def run(self, config: Config, **named: Any) -> Trajectory:
        speed = config.drive.speed_kmh
        self.begun[speed] = now()
        run = simulate(config, **named)
        run.normal_load[:MARKED, 0] = 1e3 * speed
        self.done[speed] = now()
        return run


def now() -> float:
    return 1e3 * time.time()


@contextmanager
def watched(owner: type, name: str, note: Callable[..., None]) -> Iterator[None]:
    """Calls note(*arguments) at each call of a method."""
    method = getattr(owner, name)

    def watching(self: Any, *args: Any, **named: Any) -> Any:
        note(*args)
        return method(self, *args, **named)

    setattr(owner, name, watching)
    try:
        yield
    finally:
        setattr(owner, name, method)


def measure(studies: bool = True) -> dict[str, tuple[float, str]]:
    """Name -> figure and its unit: the whole way and its parts, median and 95 %; studies: they may run beside it."""
    watch, shown = Watch(), [0.0]

    def on_change(key: str, value: float) -> None:
        watch.called[value] = now()

    def on_show(done: Finished, *_: Any) -> None:
        shown[0] = done.trajectory.config.drive.speed_kmh

    def on_flush() -> None:
        watch.published.setdefault(shown[0], now())

    with (
        chromium("--disable-gpu-compositing") as browser,
        watched(Session, "change", on_change),
        watched(Window, "show_run", on_show),
        watched(viser.ClientHandle, "flush", on_flush),
    ):
        server = Server(load_config("paper"), "paper", port=0, run=watch.run, make_view=EmptyView)
        try:
            explorer = Explorer(browser.new_page(viewport={"width": 1280, "height": 720}))
            explorer.open(f"{server.address}/?fixedDpr=0.5")
            explorer.page.get_by_label("What each slider would do").set_checked(studies)
            explorer.page.wait_for_timeout(2000)
            explorer.page.evaluate(WATCH)
            explorer.thumb("Speed").focus()
            values = explorer.value("Speed") + STEP * np.arange(1, PRESSES + 1)
            for _ in values:
                explorer.page.keyboard.press("ArrowRight")
                explorer.page.wait_for_timeout(BETWEEN)
            explorer.page.wait_for_function("last => window.drawn.at(-1)?.[0] === last", arg=float(values[-1]))
            pressed, drawn = explorer.page.evaluate("[window.pressed, window.drawn]")
        finally:
            server.stop()
    return figures(watch, values, pressed, drawn)


def figures(watch: Watch, values: np.ndarray, pressed: list[float], drawn: list[list[float]]) -> dict:
    """Latencies of all presses (the curve of that value or of a later one), and parts of those with a curve."""
    whole, parts, own = [], [], 0
    for value, press in zip(values, pressed, strict=True):
        whole.append(next(when for speed, when in drawn if speed > value - STEP / 2) - press)
        when = next((when for speed, when in drawn if abs(speed - value) < STEP / 2), None)
        marks = [times.get(value) for times in (watch.called, watch.begun, watch.done, watch.published)]
        if when is not None and None not in marks:
            own += 1
            parts.append(np.diff([press, *marks, when]))
    found = {
        "key press → curve": (median(whole), "ms"),
        "key press → curve, 95 %": (quantiles(whole, n=20)[-1], "ms"),
        "presses with a run of their own on the page": (100 * own / len(whole), "%"),
    }
    for name, column in zip(PARTS, np.array(parts).T, strict=True):
        found[f"of this {name}"] = (median(column), "ms")
        found[f"of this {name}, 95 %"] = (quantiles(column, n=20)[-1], "ms")
    return found


if __name__ == "__main__":
    for studies in (False, True, False, True):  # in turn, as other work on the machine comes and goes
        print("with studies" if studies else "without studies")
        for what, (value, unit) in measure(studies).items():
            print(f"{what:50} {value:8.1f} {unit}")
