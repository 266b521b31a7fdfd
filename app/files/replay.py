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
from app.view3d.camera import Standpoint
from app.view3d.view import View3D
from model.road.road import Road
from model.simulation.trajectory import Trajectory

RATE = 25.0  # frames a second
LONGEST = 30.0  # s of a run that are recorded: for each about 0.3 megabytes, with a ghost 0.4
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
) -> str | None:
    """A standalone page in which the run plays, can be scrubbed and looked at from all sides.

    baseline: another run, which goes along as a ghost. title: plain text, shown above the view and as the page's name.
    A run longer than LONGEST is cut there, and the page says so. It takes a few seconds: do not call it on an event
    loop. Returns None when `should_stop`, called before each frame, returns True. road: under a stretch of a drive,
    which has no ghost; a run has the road of its configuration.
    """
    duration = float(trajectory.t[-1] - trajectory.t[0])
    if duration > LONGEST:
        title += f" (the first {LONGEST:g} s of {duration:g} s)"
    page = _record(trajectory, baseline, min(duration, LONGEST), dark, standpoint, should_stop, road)
    return page and _titled(page, title, dark)


def _record(
    trajectory: Trajectory,
    baseline: Trajectory | None,
    duration: float,
    dark: bool,
    standpoint: Standpoint,
    should_stop: Callable[[], bool],
    road: Road | None,
) -> str | None:
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
        return recording.as_html(dark_mode=dark)
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


def _titled(page: str, title: str, dark: bool) -> str:
    """The page with its name in the browser's tab and over the view."""
    text = html.escape(title)
    colour = "#e6e9ec" if dark else "#2b2f33"
    caption = (
        f'<div style="position: fixed; top: 0.8em; left: 1.2em; right: 1.2em; z-index: 5; pointer-events: none; '
        f'text-align: center; font: 500 15px system-ui, sans-serif; color: {colour}">{text}</div>'
    )
    head, body = page.split("<title>Viser</title>", 1)
    body, end = body.rsplit("</body>", 1)
    return f"{head}<title>{text}</title>{body}{caption}<script>{asset('replay.js')}</script></body>{end}"
