"""Where a tab is in its run, and from where it looks: it is stored in the tab, and comes back when its page is loaded
anew.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

import numpy as np

EVERY = 1.0  # s from one place that the tab stores to the next
FAR = 1e6  # s or m: numbers beyond that are not ours


@dataclass(frozen=True)
class Place:
    """Where a tab is in its run, and from where it looks."""

    time: float  # s
    playing: bool
    position: tuple[float, ...]  # (3,) of the camera, m
    look_at: tuple[float, ...]  # (3,) m


def place_text(place: Place) -> str:
    """It as JSON."""
    return json.dumps(asdict(place))


def place_from(text: str) -> Place | None:
    """The place in a text, which anybody may have written; None: it says none."""
    try:
        place = json.loads(text)
        time, position, look_at = (np.array(place[key], dtype=float) for key in ("time", "position", "look_at"))
        playing = place["playing"]
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
        return None
    numbers = np.concatenate([time.ravel(), position.ravel(), look_at.ravel()])
    shapes = time.shape, position.shape, look_at.shape
    if shapes != ((), (3,), (3,)) or not np.all(np.abs(numbers) < FAR) or not isinstance(playing, bool):
        return None
    return Place(float(time), playing, tuple(position.tolist()), tuple(look_at.tolist()))


class TabPlace:
    """The places of one tab. Times are monotonic, in s."""

    def __init__(self) -> None:
        self._return_to: Place | None = None  # where the tab was before its page was loaded anew
        self._stored: Place | None = None
        self._due = float("inf")  # when another may be stored: not before the tab has told of the last

    def told(self, text: str) -> None:
        """The tab has told what it had stored; only the first word counts."""
        if self._due == float("inf"):
            self._return_to, self._due = place_from(text), 0.0

    def to_return_to(self) -> Place | None:
        """Where the tab was; once."""
        back, self._return_to = self._return_to, None
        return back

    def news(self, place: Place, now: float) -> str | None:
        """What the tab is to store now that it is there; None: nothing new."""
        if now < self._due or place == self._stored:
            return None
        self._stored, self._due = place, now + EVERY
        return place_text(place)
