"""Where the explorer listens, what it says, and how it ends."""

from __future__ import annotations

import gc
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
import weakref
from typing import Any

import pytest
import viser

import app.cli
import app.server
from app.commands.common import STOPPING
from app.server import Explorer, ServerError, free_port, serve
from app.web.admission import Listening
from model.config.config_files import load_config
from model.simulation.trajectory import Trajectory
from tests.app.conftest import PATIENCE, Tab, simulate_at_once, trackride_threads, wait_for

PAPER = load_config("paper")


@pytest.fixture
def taken() -> Any:
    """A port that somebody listens on."""
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        yield other.getsockname()[1]


def test_a_taken_port_leads_to_a_later_one(taken: int) -> None:
    assert free_port("127.0.0.1", 0) == 0
    free = free_port("127.0.0.1", taken)
    assert taken < free < taken + 100


@pytest.mark.parametrize("host", ["no such host", "203.0.113.7", "999.1.1.1", "\ud800", "x" * 300])
def test_a_host_that_is_not_ours_is_an_error_at_once(host: str) -> None:
    with pytest.raises(ServerError, match="cannot listen"):
        free_port(host, 8080)


@pytest.mark.parametrize("port", [-1, 65536, 10**9])
def test_a_port_that_does_not_exist_is_an_error(port: int) -> None:
    with pytest.raises(ServerError, match="does not exist"):
        free_port("127.0.0.1", port)


def test_serve_ends_with_a_message_when_it_cannot_listen() -> None:
    with pytest.raises(SystemExit, match=r"cannot listen on 203\.0\.113\.7"):
        serve(PAPER, "paper", host="203.0.113.7", open_browser=False)


def test_the_page_is_served_and_stopping_ends_everything(explore: Any, open_tab: Any) -> None:
    explorer: Explorer = explore()
    with urllib.request.urlopen(explorer.address, timeout=PATIENCE) as page:
        assert b"<html" in page.read(2000).lower()
    tab: Tab = open_tab(explorer)
    wait_for(lambda: tab.shows_run(1))
    explorer.stop()
    assert not trackride_threads()
    assert explorer.sessions == ()


def test_stopping_waits_for_a_tab_that_is_just_being_closed(explore: Any, open_tab: Any) -> None:
    """Otherwise its threads speak to a server that is gone."""
    begun, go_on = threading.Event(), threading.Event()

    def slow(config: Any, **watched: Any) -> Trajectory:
        begun.set()
        go_on.wait(PATIENCE)
        return simulate_at_once(config, **watched)

    explorer: Explorer = explore(run=slow)
    tab: Tab = open_tab(explorer)
    assert begun.wait(PATIENCE)
    wait_for(lambda: explorer.sessions, "the session")
    tab.close()
    wait_for(lambda: not explorer.server.get_clients(), "the server to notice")
    threading.Timer(0.3, go_on.set).start()
    explorer.stop()
    assert not trackride_threads()


def test_a_file_of_ones_own_stands_beside_the_presets(explore: Any, open_tab: Any) -> None:
    config = PAPER.replace({"name": "Mine", "drive.speed_kmh": 40})
    tab: Tab = open_tab(explore(config, "mine.yaml"))
    wait_for(lambda: tab.shows_run(1))
    preset = tab.widget("Preset")
    assert preset["value"] == "Mine"
    assert "Half-round obstacle" in preset["props"]["options"]
    assert tab.widget("Speed, km/h")["value"] == 40


def test_changes_to_a_preset_are_undone_by_reset(explore: Any, open_tab: Any) -> None:
    tab: Tab = open_tab(explore(PAPER.replace({"drive.speed_kmh": 40}), "paper"))
    wait_for(lambda: tab.shows_run(1))
    assert tab.widget("Speed, km/h")["value"] == 40
    tab.press("Reset all parameters")
    wait_for(lambda: tab.shows_run(2))
    wait_for(lambda: tab.widget("Speed, km/h")["value"] == 15)


def test_a_tab_that_cannot_be_set_up_is_told(explore: Any, open_tab: Any) -> None:
    def broken(client: Any, dark: bool) -> Any:
        raise RuntimeError("no scene")

    tab: Tab = open_tab(explore(make_view=broken))
    wait_for(lambda: tab.notifications, "a notification")
    wait_for(lambda: not trackride_threads(), "the threads to end")


def test_no_visitor_can_open_a_tunnel(explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = threading.Event()
    monkeypatch.setattr("viser._viser.ViserTunnel", lambda *arguments: asked.set())
    tab: Tab = open_tab(explore())
    tab.send("ShareUrlRequest")
    wait_for(lambda: tab.shows_run(1))
    assert not asked.wait(0.2)
    theme = next(message for message in tab.messages if message["type"] == "ThemeConfigurationMessage")
    assert not theme["show_share_button"]


def test_memory_comes_back_when_a_tab_has_closed(explore: Any, open_tab: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(app.server, "CLOSED_FOR", 1.0)  # s; viser lets go of the tab meanwhile
    explorer: Explorer = explore()
    staying, tab = open_tab(explorer), open_tab(explorer)
    wait_for(lambda: staying.shows_run(1) and tab.shows_run(1))
    gc.disable()  # which may happen to look for it otherwise
    try:
        sessions = [weakref.ref(session) for session in explorer.sessions]
        shown = [weakref.ref(session.shown) for session in explorer.sessions]
        tab.close()
        wait_for(lambda: sum(ref() is None for ref in sessions) == sum(ref() is None for ref in shown) == 1)
    finally:
        gc.enable()
    staying.use("Speed, km/h", 20)
    wait_for(lambda: staying.shows_run(2))


def test_what_a_page_sends_again_and_again_fills_no_log(
    explore: Any, open_tab: Any, caplog: pytest.LogCaptureFixture
) -> None:
    tab: Tab = open_tab(explore())
    wait_for(lambda: tab.shows_run(1))
    speed = tab.find("Speed, km/h")
    for number in range(50):
        tab.send("GuiUpdateMessage", uuid=speed, updates={f"nothing {number}": number})
        tab.send("GuiUpdateMessage", uuid=speed, updates={"value": f"no number {number}"})
    tab.use("Speed, km/h", 20)
    wait_for(lambda: tab.shows_run(2))
    gc.collect()  # asyncio tells of a task's error when the task goes
    assert 1 <= len(caplog.messages) <= 2


@pytest.mark.parametrize("with_token", [True, False])
def test_it_warns_when_others_can_open_it(
    with_token: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupt(server: viser.ViserServer) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(viser.ViserServer, "sleep_forever", interrupt)
    monkeypatch.setattr(Listening, "from_elsewhere", "192.0.2.7")
    serve(PAPER, "paper", host="0", port=0, open_browser=False, with_token=with_token)
    said = capsys.readouterr().out
    page, elsewhere = (re.search(f"{start}: http://([^/ ]+):\\d+(/?\\S*)", said) for start in ("explorer", "machines"))
    assert page is not None
    assert elsewhere is not None
    assert (page[1], elsewhere[1]) == ("127.0.0.1", "192.0.2.7")
    assert page[2] == elsewhere[2]
    assert bool(page[2]) == with_token
    assert ("Everyone in this network" in said) != with_token
    assert ("with its token" in said) == with_token


def started(*options: str) -> subprocess.Popen[str]:
    """`trackride explore` in a process of its own, which heeds interrupts whatever the tests were started by."""
    return subprocess.Popen(
        [sys.executable, "-m", "app", "explore", "--no-browser", *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )


def test_it_says_where_it_is_and_ends_on_interrupt(taken: int) -> None:
    with started("--port", str(taken)) as process:
        try:
            assert process.stdout is not None
            said = [process.stdout.readline(), process.stdout.readline()]
            process.send_signal(signal.SIGINT)
            rest, errors = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
    port = int(said[0].rsplit(" ", 1)[1].strip(".\n"))
    assert f"Port {taken} is taken" in said[0]
    assert port != taken
    assert f"http://127.0.0.1:{port} " in said[1]
    assert "Traceback" not in errors
    assert process.returncode == 0
    assert "Stopping" in rest


def test_what_would_not_end_after_an_interrupt_is_ended() -> None:
    """As code that loses the exception, or waits for a thread that compiles."""
    code = (
        "import app.server, app.cli, time\n"
        "def serve(*given, **options):\n"
        "    while True:\n"
        "        try: print('begun') or time.sleep(60)\n"
        "        except KeyboardInterrupt: print('lost')\n"
        "app.server.serve = serve\n"
        "app.cli.main()"
    )
    command = [sys.executable, "-u", "-c", code, "explore"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "begun\n"
            sent = time.monotonic()
            process.send_signal(signal.SIGINT)
            assert process.communicate(timeout=PATIENCE) == ("lost\nbegun\n", "")
            assert time.monotonic() - sent >= STOPPING
        finally:
            process.kill()


def test_an_interrupt_while_it_is_loaded_ends_it_at_once() -> None:
    """Here at the first library that the command loads."""
    code = (
        "import sys, time\n"
        "class Slow:\n"
        "    def find_spec(self, name, *rest):\n"
        "        while name == 'typer':\n"
        "            print('loading')\n"
        "            try: time.sleep(60)\n"
        "            except BaseException: pass\n"
        "sys.meta_path.insert(0, Slow())\n"
        "from app.__main__ import main\n"
        "main()"
    )
    command = [sys.executable, "-u", "-c", code, "explore"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "loading\n"
            process.send_signal(signal.SIGINT)
            assert process.communicate(timeout=PATIENCE) == ("", "")
            assert process.returncode == -signal.SIGINT
        finally:
            process.kill()


def test_the_browser_opens_the_address_in_use(monkeypatch: pytest.MonkeyPatch, taken: int) -> None:
    opened: list[str] = []
    monkeypatch.setattr(app.server.webbrowser, "open", lambda address: bool(opened.append(address)) or True)

    def interrupt(server: viser.ViserServer) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(viser.ViserServer, "sleep_forever", interrupt)
    serve(PAPER, "paper", port=taken)
    assert opened[0].startswith("http://127.0.0.1:")
    assert not opened[0].endswith(f":{taken}")


def test_nobody_waits_for_libraries_that_are_needed_later() -> None:
    """Not for Numba until it listens, not for solids and figures until the panels stand; pyplot is never loaded."""
    code = "; ".join(
        f"import {module}; print(*sys.modules)" for module in ("app.server", "app.session.session", "app.reports.sheet")
    )
    done = subprocess.run([sys.executable, "-c", f"import sys; {code}"], capture_output=True, text=True, check=True)
    to_listen, to_fill, to_draw = (set(line.split()) for line in done.stdout.splitlines())
    assert not to_listen & {"numba", "scipy"}
    assert not to_fill & {"scipy.spatial", "scipy.signal", "scipy.optimize", "trimesh", "matplotlib"}
    assert "matplotlib" in to_draw
    assert "matplotlib.pyplot" not in to_draw
