"""The line that says which run or drive is shown, as HTML. Pure."""

from __future__ import annotations

from app.format.markup import Content, element
from app.runs.drive import DriveState
from model.simulation.trajectory import Trajectory

BUSY_DELAY = 0.2  # s before a run is said to be under way; for quick ones the line would only flicker
SLOW_START = 1.5  # s that the model takes to load: it is being compiled
FIRST_START = "compiling the model, for half a minute…"


def run_line(number: int, run: Trajectory) -> str:
    """HTML: how long a run took."""
    took = run.statistics.seconds
    reached = float(run.t[-1]) if len(run.t) else 0.0
    speed = f"{reached / took:.0f}× real time" if took > 0 else ""
    facts = f"{reached:.3g} s in {1e3 * took:.0f} ms · {speed}"
    return status_line(f"Run {number}", facts, "" if run.complete else "not complete")


def progress_line(number: int, part: float | None, seconds: float) -> str:
    """HTML: how far a run is, part 0…1 or None while the model is loaded, after so many seconds."""
    doing = FIRST_START if part is None and seconds > SLOW_START else f"computing… {100 * (part or 0.0):.0f} %"
    return status_line(f"Run {number}", doing)


def drive_facts(state: DriveState) -> str:
    """What the status line says of a drive."""
    if state.ended:
        return "it came to an end; look back, or restart"
    return "look back with ← or the slider" if state.stands else "changes act at once"


def status_line(name: str, facts: str, trouble: str = "") -> str:
    """HTML of the line that says which run this is."""
    bad: list[Content] = [" · ", element("span", trouble, class_="bad")] if trouble else []
    return str(element("div", element("b", name), " · ", facts, *bad, class_="trackride-status"))
