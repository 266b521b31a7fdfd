"""Stand-ins for what the explorer meets: a browser tab that speaks viser's protocol, a 3-D view, runs made by hand."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import Any

import msgspec
import numpy as np
import pytest
import viser
import zstandard
from websockets.exceptions import ConnectionClosedOK
from websockets.sync.client import connect

from app.format.units import Units
from app.server import Explorer
from model.analysis.wheel_contact import WheelState, wheel_state
from model.config.config import Config
from model.config.config_files import load_config
from model.dynamics.vehicle import build_system
from model.road.road import Road
from model.simulation.trajectory import RunStatistics, Trajectory
from model.study.running import Outcome

PATIENCE = 60.0  # s that a test waits for something to happen, on a busy machine


def as_typed(label: str) -> str:
    """A label without what keeps its unit on one line."""
    return label.replace("\u00a0", " ")


def wait_for(condition: Callable[[], Any], what: str = "it") -> Any:
    """The first true answer of the condition; one that looks for what is not there yet has none."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with suppress(LookupError):
            answer = condition()
            if answer:
                return answer
        time.sleep(0.005)
    raise AssertionError(f"waited {PATIENCE:g} s for {what}")


def pass_frames(explorer: Explorer, count: int = 4) -> None:
    """Until the view of the newest tab has been drawn so many times, or would have been."""
    for _ in range(count):
        explorer.sessions[-1].show_now(lambda: None)


def trackride_threads() -> set[str]:
    """Names of the sessions' threads that are alive."""
    return {thread.name for thread in threading.enumerate() if thread.name.startswith("trackride")}


def make_run(
    config: Config | None = None, samples: int = 201, status: str = "complete", advice: str = ""
) -> Trajectory:
    """A run at 100 samples a second whose loads and accelerations are as large as the speed (km/h) says."""
    config = config or load_config("paper")
    system = build_system(config)
    bodies, wheels = len(system.mass), len(system.wheel)
    t = np.arange(samples) / 100
    q = np.tile(system.q_design, (samples, 1, 1))
    wave = np.sin(2 * np.pi * t)[:, None]
    return Trajectory(
        t=t,
        q=q,
        v=np.zeros_like(q),
        a=np.tile(wave[..., None], (1, bodies, 3)) * config.drive.speed_kmh,
        normal_load=1e3 * config.drive.speed_kmh + 100 * wave * np.arange(1, wheels + 1),
        traction=np.zeros((samples, wheels)),
        tangential_displacement=np.zeros((samples, wheels)),
        drive_force=np.zeros(samples),
        multipliers=np.zeros((samples, 2 * len(system.joint_i))),
        constraint_residual=np.zeros(samples),
        static_load=np.zeros(wheels),
        config=config,
        status=status,
        advice=advice,
        statistics=RunStatistics(100, 1, 600, 1e-4, 0.05),
    )


def simulate_at_once(
    config: Config, *, on_progress: Callable[[float], None], should_stop: Callable[[], bool]
) -> Trajectory:
    on_progress(1.0)
    return make_run(config)


class FakeView:
    """A 3-D view that remembers what it was told."""

    def __init__(self, client: viser.ClientHandle, dark: bool) -> None:
        self.client, self.dark = client, dark
        self.switches: dict[str, bool] = {}  # that were used
        self.ghosts: list[Trajectory | None] = []
        self.ghost_of_other_size = False
        self.runs: list[Trajectory] = []
        self.roads: list[Road] = []  # of the drive
        self.times: list[float] = []
        self.views: list[str] = []
        self.threads: set[str] = set()
        self.marks_obstacle = False

    def show(self, trajectory: Trajectory) -> None:
        self.runs.append(trajectory)
        self.threads.add(threading.current_thread().name)

    def show_live(self, recent: Trajectory, road: Road) -> None:
        self.runs.append(recent)
        self.roads.append(road)

    def show_ghost(self, trajectory: Trajectory | None) -> None:
        self.ghosts.append(trajectory)

    def show_beside(self, runs: Sequence[tuple[Trajectory, str]]) -> None:
        self.beside = list(runs)

    def draw(self, time: float) -> None:
        self.times.append(time)
        self.threads.add(threading.current_thread().name)

    def on_pick(self, act: Callable[[int], None]) -> None:
        self.pick = act

    def mark_wheel(self, wheel: int | None) -> None:
        self.marked = wheel

    def wheel_state(self, wheel: int) -> WheelState | None:
        return wheel_state(self.runs[-1], wheel, self.times[-1])

    def fit_page(self, height: int, covered: float, type_scale: float) -> None:
        self.fitted = height, covered, type_scale

    def write_names(self) -> None:
        pass

    load_top = None
    turned_camera: tuple[float, ...] = ()

    def set_view(self, standpoint: str) -> None:
        self.views.append(standpoint)

    def mark_obstacle(self, on: bool) -> None:
        self.marks_obstacle = on

    def set_switch(self, name: str, on: bool) -> None:
        self.switches[name] = on

    def set_arrow_scale(self, scale: float) -> None:
        pass

    def show_surroundings(self, on: bool) -> None:
        pass

    def set_dark(self, dark: bool) -> None:
        self.dark = dark

    def set_units(self, units: Units) -> None:
        self.units = units


class Tab:
    """A browser tab as far as the server can tell: it keeps what it is sent, and can use any control."""

    def __init__(
        self,
        explorer: Explorer,
        width: int = 1600,
        height: int = 900,
        storage: dict[str, str] | None = None,
        mute: bool = False,
        stands: bool = True,
        visit: str = "null",
        place: str = "null",
    ) -> None:
        """storage: what the browser has kept from earlier visits; mute: it does not tell.

        stands: the page says, as soon as it can, that its panels stand with the loads in front.
        visit, place: what the tab has stored itself before its page was loaded anew.
        """
        self._socket = connect(
            explorer.address.replace("http", "ws"),
            subprotocols=[f"viser-v{viser.__version__}"],  # type: ignore[list-item]
            compression=None,
            max_size=None,
        )
        self.widgets: dict[str, dict[str, Any]] = {}  # uuid -> type, value and props
        self.notifications: list[dict[str, Any]] = []
        self.storage: dict[str, str] = {} if storage is None else storage
        self._mute, self._stands = mute, stands
        self._stored = {"Visit": visit, "Place": place}
        self.messages: list[dict[str, Any]] = []
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()
        self.send(
            "ViewerCameraMessage",
            wxyz=(1, 0, 0, 0),
            position=(0, -9, 1),
            fov=0.5,
            near=0.01,
            far=1000,
            image_height=height,
            image_width=width,
            look_at=(0, 0, 0),
            up_direction=(0, 0, 1),
        )

    def send(self, kind: str, **content: Any) -> None:
        self._socket.send(msgspec.msgpack.encode({"type": kind, **content}))

    def use(self, label: str, value: Any) -> None:
        """Set a control as the page does."""
        self.send("GuiUpdateMessage", uuid=self.find(label), updates={"value": value})

    def press(self, command: str) -> None:
        """Run a command of the palette."""
        uuid = wait_for(
            lambda: next(
                (
                    message["uuid"]
                    for message in tuple(self.messages)
                    if message["type"] == "RegisterCommandMessage" and message["props"]["label"] == command
                ),
                None,
            ),
            command,
        )
        self.send("CommandTriggerMessage", uuid=uuid)

    def find(self, label: str) -> str:
        """The uuid of the control with this label."""
        return wait_for(
            lambda: next(
                (
                    uuid
                    for uuid, widget in tuple(self.widgets.items())
                    if as_typed(widget["props"].get("label") or "") == label and widget["props"].get("visible", True)
                ),
                None,
            ),
            f"a control called {label}",
        )

    def widget(self, label: str) -> dict[str, Any]:
        return self.widgets[self.find(label)]

    def charts(self) -> list[dict[str, Any]]:
        """Props of the plots, from top to bottom; their data as arrays."""
        charts = [w["props"] for w in tuple(self.widgets.values()) if w["type"] == "GuiUplotMessage"]
        return sorted(charts, key=lambda props: props["order"])

    @property
    def status(self) -> str:
        """HTML of the line that tells the run."""
        return self.html("trackride-status")

    def html(self, part: str) -> str:
        """The HTML, other than rules of style, that has this in it."""
        texts = [w["props"]["content"] for w in tuple(self.widgets.values()) if w["type"] == "GuiHtmlMessage"]
        return next((text for text in texts if part in text and "<style" not in text), "")

    def shows_run(self, number: int) -> bool:
        return f"<b>Run {number}</b>" in self.status and " in " in self.status

    def close(self) -> None:
        self._socket.close()
        self._thread.join()

    def _listen(self) -> None:
        with suppress(ConnectionClosedOK):  # what is asked of a tab that has just been closed is not answered
            self._take_in()

    def _take_in(self) -> None:
        unpack = zstandard.ZstdDecompressor()
        for data in self._socket:
            assert isinstance(data, bytes)
            size, packed = (int.from_bytes(data[i : i + 8], "little") for i in (0, 8))
            window = msgspec.msgpack.decode(unpack.decompress(data[16 : 16 + packed], max_output_size=size))
            offset, arrays = 16 + packed, []
            for length in window["binaryBufferLengths"]:
                offset += -offset % 8
                arrays.append(data[offset : offset + length])
                offset += length
            for message in window["messages"]:
                self._receive(_with_arrays(message, arrays))

    def _receive(self, message: dict[str, Any]) -> None:
        self.messages.append(message)
        kind = message["type"]
        if kind == "GuiUpdateMessage" and message["uuid"] in self.widgets:
            widget = self.widgets[message["uuid"]]
            for name, value in message["updates"].items():
                (widget if name == "value" else widget["props"])[name] = value
        elif kind == "GuiRemoveMessage":
            self.widgets.pop(message["uuid"], None)
        elif kind.startswith("Gui") and "props" in message:
            self.widgets[message["uuid"]] = message
            if self._stands and message["props"].get("label") == "Tabs in front":
                self.send("GuiUpdateMessage", uuid=message["uuid"], updates={"value": "Loads"})
            if message["props"].get("label") in self._stored:
                stored = self._stored[message["props"]["label"]]
                self.send("GuiUpdateMessage", uuid=message["uuid"], updates={"value": stored})
        elif kind == "LocalStorageSetItemMessage":
            self.storage[message["key"]] = message["value"]
        elif kind == "LocalStorageGetItemRequestMessage" and not self._mute:
            self.send(
                "LocalStorageGetItemResponseMessage",
                value=self.storage.get(message["key"]),
                error=None,
                request_uuid=message["request_uuid"],
            )
        elif kind == "NotificationShowMessage":
            self.notifications.append(message["props"])


def _with_arrays(value: Any, arrays: list[bytes]) -> Any:
    if isinstance(value, dict):
        if "__binary_index" in value:
            return np.frombuffer(arrays[value["__binary_index"]], value["dtype"])
        return {key: _with_arrays(inner, arrays) for key, inner in value.items()}
    if isinstance(value, list):
        return [_with_arrays(inner, arrays) for inner in value]
    return value


def study_nothing(base: Config, changes: Any, figures: tuple[str, ...], *, should_stop: Callable[[], bool]) -> Outcome:
    return Outcome("failed: nothing is studied here", (None,) * len(figures))


@pytest.fixture
def explore() -> Iterator[Callable[..., Explorer]]:
    """Starts explorers on the paper's vehicle and ends them, with the arguments of Session to change."""
    started: list[Explorer] = []

    def start(config: Config | None = None, preset: str = "paper", **session: Any) -> Explorer:
        session = {"run": simulate_at_once, "make_view": FakeView, "study": study_nothing} | session
        started.append(Explorer(config or load_config("paper"), preset, port=0, **session))
        return started[-1]

    yield start
    for explorer in started:
        explorer.stop()


@pytest.fixture
def open_tab() -> Iterator[Callable[..., Tab]]:
    """Opens tabs, and closes those that are still open at the end."""
    tabs: list[Tab] = []

    def open_it(explorer: Explorer, **browser: Any) -> Tab:
        tabs.append(Tab(explorer, **browser))
        return tabs[-1]

    yield open_it
    for tab in tabs:
        tab.close()
