"""A run as one HTML file that opens from disk and plays: recorded from a server that is made for it and thrown away."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import rich
import viser

from app.format.assets import asset
from app.format.colours import DARK, LIGHT
from app.format.markup import element
from app.view3d.camera import Standpoint
from app.view3d.meshes.running_gear import IMAGINARY
from app.view3d.overlays import IN_AIR
from app.view3d.view import View3D
from model.road.road import Road
from model.simulation.trajectory import Trajectory

RATE = 25.0  # frames a second
LONGEST = 30.0  # s of a run that are recorded: for each about 0.3 megabytes, with a ghost 0.4
SIGN = "display: inline-block; margin-right: 0.6em; vertical-align: middle"
DISC = "width: 0.9em; height: 0.9em; border-radius: 50%; opacity: 0.7; background:"  # CSS, before a colour
RING = "width: 0.7em; height: 0.7em; border-radius: 50%; border: 0.16em solid"
INK = {False: "#2b2f33", True: "#e6e9ec"}  # of texts, in the light look and in the dark one
TYPE = "font: 13px/1.6 system-ui, sans-serif"
WINDOW = (1600, 900)  # pixels, whose shape the view is fitted to


@dataclass
class _FixedCamera:
    """A camera that remembers where it is put."""

    image_width, image_height = WINDOW
    fov: float = 0.0
    position: Any = None
    look_at: Any = None
    up_direction: Any = None
    max_orbit_distance: Any = None

    def on_update(self, callback: Any) -> None:
        """Nobody moves it, so there is nothing to call."""


class _SharedTab:
    """A tab without a browser: the scene that all visitors of the throwaway server would share."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.scene, self.atomic, self.camera = server.scene, server.atomic, _FixedCamera()


def replay_html(
    trajectory: Trajectory,
    baseline: Trajectory | None,
    title: str,
    dark: bool = False,
    standpoint: Standpoint = "three-quarter",
    should_stop: Callable[[], bool] = lambda: False,
    road: Road | None = None,
    baseline_title: str = "",
) -> str | None:
    """A standalone page with a key to its colours, in which the run plays, can be scrubbed and seen from all sides.

    baseline: another run, which goes along as a ghost. Titles: plain text; the run's stands above the view and is the
    page's name, the baseline's stands in the key.
    A run longer than LONGEST is cut there, and the page says so. It takes a few seconds: do not call it on an event
    loop. Returns None when `should_stop`, called before each frame, returns True. road: under a stretch of a drive,
    which has no ghost; a run has the road of its configuration.
    """
    duration = float(trajectory.t[-1] - trajectory.t[0])
    if duration > LONGEST:
        title += f" (the first {LONGEST:g} s of {duration:g} s)"
    recorded = _record(trajectory, baseline, min(duration, LONGEST), dark, standpoint, should_stop, road)
    if recorded is None:
        return None
    page, with_ghost = recorded
    return _titled(page, title, dark, _key(trajectory, baseline_title if with_ghost else None, dark))


def _record(
    trajectory: Trajectory,
    baseline: Trajectory | None,
    duration: float,
    dark: bool,
    standpoint: Standpoint,
    should_stop: Callable[[], bool],
    road: Road | None,
) -> tuple[str, bool] | None:
    """The page, and whether it shows a ghost."""
    with _silence():
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        tab = _SharedTab(server)
        view = View3D(tab, dark)
        view.show(trajectory) if road is None else view.show_live(trajectory, road)
        view.show_ghost(baseline)
        view.set_view(standpoint)
        start, camera = server.initial_camera, tab.camera
        start.fov, start.up = camera.fov, camera.up_direction
        start.position, start.look_at = camera.position, camera.look_at
        recording = server.get_scene_serializer()
        for frame in range(int(duration * RATE) + 1):
            if should_stop():
                return None
            view.draw(float(trajectory.t[0]) + frame / RATE)
            recording.insert_sleep(1 / RATE)
        return recording.as_html(dark_mode=dark), not (baseline is None or road is not None or view.ghost_of_other_size)
    finally:
        with _silence():
            server.stop()


@contextmanager
def _silence() -> Iterator[None]:
    """Without viser's announcements, which go to rich's common console; several threads may be in here at once."""
    console = rich.get_console()
    console.quiet = True
    try:
        yield
    finally:
        console.quiet = False


def _key(run: Trajectory, baseline_title: str | None, dark: bool) -> str:
    """What the colours mean. baseline_title: None: there is no ghost."""
    theme = DARK if dark else LIGHT
    told = []
    if baseline_title is not None:
        told.append(("width: 1.6em; border-top: 3px solid", theme.ghost, f"Baseline: {baseline_title}".rstrip(": ")))
    if run.system.m:
        told.append((DISC, IMAGINARY, "Imaginary wheel, for the track between road wheels"))
    if bool((run.normal_load <= 0.0).any()):
        told.append((RING, IN_AIR, "Wheel in the air"))
    rows = (
        element(
            "div",
            element("i", style=f"{SIGN}; {sign} rgb{colour}"),
            words,
        )
        for sign, colour, words in told
    )
    place = "position: fixed; left: 1.2em; bottom: 4em; z-index: 5; pointer-events: none"
    look = f"{place}; color: {INK[dark]}; {TYPE}"
    return str(element("div", *rows, style=look, class_="trackride-key"))


def _titled(page: str, title: str, dark: bool, key: str) -> str:
    """The page with its name in the browser's tab and over the view, and the key in its corner."""
    text = html.escape(title)
    caption = (
        f'<div style="position: fixed; top: 0.8em; left: 1.2em; right: 1.2em; z-index: 5; pointer-events: none; '
        f'text-align: center; font: 500 15px system-ui, sans-serif; color: {INK[dark]}">{text}</div>'
    )
    head, body = page.split("<title>Viser</title>", 1)
    body, end = body.rsplit("</body>", 1)
    return f"{head}<title>{text}</title>{body}{caption}{key}<script>{asset('replay.js')}</script></body>{end}"
