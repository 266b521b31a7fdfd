"""What a browser keeps of a tab from one visit to the next: a text made of configurations, and back. Pure."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar

from app.format.units import METRIC, Units
from app.runs.history import RUN_COLOURS, RUNS, Kept, plain_name, run_name
from app.runs.request import Request, first_request
from model.config.config import Config, ConfigError
from model.config.config_files import part_values

PRESETS = 30  # of the user's own, at most
LONGEST = 1_000_000  # characters of a text that is looked at: more than all presets and runs take
REQUEST = "wish"  # key of the request: browsers have stored it under this name
BAD = (
    ValueError,
    TypeError,
    KeyError,
    AttributeError,
    ConfigError,
)  # errors of reading a text that anybody may have written

T = TypeVar("T")


@dataclass(frozen=True)
class State:
    """What a tab finds again at its next visit."""

    start: Config | None  # what the explorer was started with
    request: Request | None  # what was shown
    presets: tuple[Config, ...]  # the user's own, oldest first
    runs: tuple[Kept, ...]  # without their trajectories, oldest first
    baseline: Kept | None
    dark: bool | None  # the look that was chosen; None: the browser's own
    units: Units = METRIC  # that were chosen


def state_text(
    start: Config,
    request: Request,
    presets: Iterable[Config],
    runs: Iterable[Kept],
    baseline: Kept | None,
    dark: bool | None,
    units: Units = METRIC,
) -> str:
    """All of it as JSON; of runs only what is needed to make them again."""
    return json.dumps(
        {
            "start": start.values(),
            REQUEST: request_values(request, request.config()),
            "presets": [preset.values() for preset in presets],
            "runs": [run_values(kept) for kept in runs],
            "baseline": None if baseline is None else run_values(baseline),
            "dark": dark,
            "units": units.chosen,
        },
        default=part_values,  # of the roads that a sum is made of
    )


def state_from(text: str) -> State:
    """All that is valid in a text, which anybody may have written. Raises ValueError when it is no state at all."""
    if len(text) > LONGEST:
        raise ValueError(f"it is longer than {LONGEST} characters")
    try:
        state = json.loads(text)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    if not isinstance(state, dict):
        raise ValueError("it is no state of the explorer")
    return State(
        start=_usable(config_from, state.get("start")),
        request=_usable(request_from, state.get(REQUEST)),
        presets=_all_usable(config_from, state.get("presets"), PRESETS),
        runs=_all_usable(run_from, state.get("runs"), RUNS),
        baseline=_usable(run_from, state.get("baseline")),
        dark=state.get("dark") if isinstance(state.get("dark"), bool) else None,
        units=_usable(METRIC.changed, state.get("units")) or METRIC,
    )


def request_values(request: Request, config: Config) -> dict[str, Any]:
    """A request for JSON; config: of the request."""
    return {"base": request.base.values(), "config": config.values()}


def run_values(kept: Kept) -> dict[str, Any]:
    """What is needed to make a kept run again, for JSON."""
    about = {"name": kept.given_name, "colour": kept.colour}
    return about | request_values(kept.request, kept.config)


def config_from(values: Any) -> Config:
    """A configuration of its values by key. Like the next two it raises one of BAD for what is none."""
    return Config().replace(values)


def request_from(values: Any) -> Request:
    """What `request_values` has given."""
    return first_request(config_from(values["base"]), config_from(values["config"]))


def run_from(values: Any) -> Kept:
    """What `run_values` has given, with the number 0."""
    request, name, colour = request_from(values), plain_name(str(values["name"])), values["colour"]
    if colour not in RUN_COLOURS:
        raise ValueError("no colour of a run")
    config = request.config()
    return Kept(0, request, config, None, name or run_name(request.base, config), colour, named=bool(name))


def _usable(read: Callable[[Any], T], values: Any) -> T | None:
    try:
        return read(values)
    except BAD:
        return None


def _all_usable(read: Callable[[Any], T], values: Any, most: int) -> tuple[T, ...]:
    """The newest that can be used."""
    found = (_usable(read, one) for one in values[-most:]) if isinstance(values, list) else ()
    return tuple(one for one in found if one is not None)
