"""What a page shows as the fragment of an address, and back: "m113&road.type=half_round&drive.speed_kmh=25". Pure.

First the preset that comes nearest, then each value that differs from it, as a file would give it. `vs` is the
baseline, written in the same way: "paper&drive.speed_kmh=20&vs=paper&vs.drive.speed_kmh=10". `view`, `wheel`, `tab`,
`time` and `camera` say how one looks at it. Whoever opens a link gets what it says checked like a file.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote, unquote_plus

from model.config.config import Config, ConfigError, Fault, SumRoad
from model.config.config_files import part_values
from model.config.parameters import PARAMETER, PART_LIMIT, Parameter
from model.config.validation import EXCLUSIVE, shorten

LONGEST = 8000  # characters of a link that is given: mail and chat pass no longer ones on
READABLE = 200_000  # characters of a link that is looked at
VERSUS, VIEW, WHEEL, TAB, TIME, CAMERA = "vs", "view", "wheel", "tab", "time", "camera"
FAR = 1e4  # s or m, beyond which no time or place is taken
PLAIN = ",:;/"  # characters that need no % in a fragment, beside letters, digits and ._-~
PART = re.compile(r"road\.parts\.(\d{1,3})\.(\w+)", re.ASCII)
WHEEL_NAME = re.compile(r"[RI][1-9]\d?", re.ASCII)


@dataclass(frozen=True)
class Look:
    """How one looks at what a page shows. Empty or None: as usual."""

    view: str = ""  # standpoint (app/view3d/camera.py)
    wheel: str = ""  # the one whose card is shown, "R3"
    tab: str = ""  # of the plots, in front
    time: float | None = None  # s, of a run that is paused
    camera: tuple[float, ...] = ()  # m, of a camera that was turned by hand: where it stands and what it looks at, (6,)


@dataclass(frozen=True)
class Link:
    """What a page shows."""

    preset: str  # that comes with the program
    config: Config
    baseline_preset: str = ""  # the same of the baseline; empty: none
    baseline: Config | None = None
    look: Look = Look()


def link_text(link: Link, presets: Mapping[str, Config]) -> str:
    """The fragment, without its #. presets: those that come with the program, `link.preset` among them."""
    words = [quote(link.preset), *_pairs("", presets[link.preset], link.config)]
    if link.baseline is not None:
        words.append(f"{VERSUS}={quote(link.baseline_preset)}")
        words += _pairs(f"{VERSUS}.", presets[link.baseline_preset], link.baseline)
    look = link.look
    looks = {VIEW: look.view, WHEEL: look.wheel, TAB: look.tab, TIME: _text(look.time), CAMERA: _text(look.camera)}
    words += [f"{key}={_quoted(value)}" for key, value in looks.items() if value]
    return "&".join(words)


def link_from(text: str, presets: Mapping[str, Config], views: Collection[str], tabs: Collection[str]) -> Link:
    """What a fragment says. views, tabs: those that there are. Raises ConfigError with all faults."""
    if len(text) > READABLE:
        raise ConfigError([Fault("", "", f"the link is longer than {READABLE} characters")])
    first, *words = text.split("&")
    faults: list[Fault] = []
    given: dict[str, str] = {}
    for word in words:
        key, equals, value = (unquote_plus(part) for part in word.partition("="))
        if not equals:
            faults.append(Fault("", shorten(key), f"{shorten(key)} is not understood; give key=value"))
        elif key in given:
            faults.append(Fault(shorten(key), shorten(value), "is given twice"))
        else:
            given[key] = value
    look = _look({key: given.pop(key, "") for key in (VIEW, WHEEL, TAB, TIME, CAMERA)}, views, tabs, faults)
    versus = given.pop(VERSUS, None)
    others = {key.removeprefix(f"{VERSUS}."): given.pop(key) for key in tuple(given) if key.startswith(f"{VERSUS}.")}
    if others and versus is None:
        faults.append(Fault(VERSUS, "nothing", f"the baseline's preset is missing; give {VERSUS}={quote(first)}"))
    preset = unquote_plus(first)
    config = _config(preset, given, presets, faults)
    baseline = None if versus is None else _config(versus, others, presets, faults)
    if faults or config is None:
        raise ConfigError(faults)
    return Link(preset, config, versus or "", baseline, look)


def nearest_preset(config: Config, presets: Mapping[str, Config], wanted: str = "") -> str:
    """The name of the preset from which least differs; of several the one that is wanted."""
    return min(presets, key=lambda name: (len(_changes(presets[name], config)), name != wanted))


def _look(given: Mapping[str, str], views: Collection[str], tabs: Collection[str], faults: list[Fault]) -> Look:
    """How one is to look, and more faults where that cannot be."""
    time, camera = _numbers(given[TIME]), _numbers(given[CAMERA])
    for key, fine, allowed in (
        (VIEW, given[VIEW] in views, "one of " + ", ".join(views)),
        (WHEEL, WHEEL_NAME.fullmatch(given[WHEEL]), "a wheel's name, such as R1 or I3"),
        (TAB, given[TAB] in tabs, "one of " + ", ".join(tabs)),
        (TIME, len(time) == 1 and time[0] >= 0, "a time of the run, s"),
        (CAMERA, len(camera) == 6 and camera[:3] != camera[3:], "six numbers, m: where it stands, what it looks at"),
    ):
        if given[key] and not fine:
            faults.append(_not_allowed(key, given[key], allowed))
    return Look(given[VIEW], given[WHEEL], given[TAB], time[0] if time else None, camera)


def _numbers(text: str) -> tuple[float, ...]:
    """Those with commas between; none where one of them is none, or too far."""
    try:
        numbers = tuple(map(float, text.split(",")))
    except ValueError:
        return ()
    return numbers if all(abs(number) < FAR for number in numbers) else ()


def _config(name: str, given: Mapping[str, str], presets: Mapping[str, Config], faults: list[Fault]) -> Config | None:
    """The preset of that name with these values; None, and more faults, where that cannot be."""
    if name not in presets:
        faults.append(_not_allowed("preset", name, "one of " + ", ".join(presets)))
        return None
    changes: dict[str, Any] = {}
    parts: dict[int, dict[str, Any]] = {}
    for key, text in given.items():
        found = PART.fullmatch(key)
        row = PARAMETER.get(f"road.{found[2]}" if found else key)
        value = text if row is None else _value(row, text)
        if found and int(found[1]) <= PART_LIMIT:
            parts.setdefault(int(found[1]), {})[found[2]] = value
        else:
            changes[key] = value
    if parts:
        changes["road.parts"] = [parts[number] for number in sorted(parts)]
    try:
        return presets[name].replace(changes)
    except ConfigError as error:
        faults += error.faults
        return None


def _changes(preset: Config, config: Config) -> dict[str, Any]:
    """Values by key that lead from a preset to the configuration; None: the preset's is taken away."""
    start = preset
    if config.road.type != preset.road.type:
        with suppress(ConfigError):  # an obstacle's usual place is under this vehicle: all of the road is told
            start = preset.replace({"road.type": config.road.type})
    before, after = start.values(), config.values()
    changes = {key: value for key, value in after.items() if before.get(key) != value}
    implied = {other for one, others in EXCLUSIVE if one in after for other in others}
    gone = {key: None for key in before if key not in after and key not in implied and PARAMETER[key].optional}
    road = {"road.type": config.road.type} if config.road.type != preset.road.type else {}
    return road | {key: value for key, value in (changes | gone).items() if PARAMETER[key].applies_to(config.road.type)}


def _pairs(prefix: str, preset: Config, config: Config) -> Iterator[str]:
    """ "key=value" for each difference."""
    for key, value in _changes(preset, config).items():
        if key == "road.parts" and value:
            yield from _part_pairs(prefix, config)
        else:
            yield f"{prefix}{key}={_quoted(_text(value))}"


def _part_pairs(prefix: str, config: Config) -> Iterator[str]:
    """Those of the roads that a sum is made of."""
    assert isinstance(config.road, SumRoad)
    for number, part in enumerate(config.road.parts, 1):
        for name, value in part_values(part).items():
            if name == "type" or value != PARAMETER[f"road.{name}"].default:
                yield f"{prefix}road.parts.{number}.{name}={_quoted(_text(value))}"


def _text(value: Any) -> str:
    """A value as a file gives it, all of its digits."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:g}" if float(f"{value:g}") == value else repr(value)
    return ",".join(map(_text, value)) if isinstance(value, tuple) else str(value)


def _value(row: Parameter, text: str) -> Any:
    """What a text means for a parameter; the table says later whether it is allowed."""
    if not text and row.optional:
        return None
    if row.kind in ("columns", "units", "parts") and not text:
        return ()
    if row.kind in ("list", "columns", "units") or (row.per_wheel and "," in text):
        return text.split(",")
    return text


def _quoted(text: str) -> str:
    return quote(text, safe=f"{PLAIN} ").replace(" ", "+")


def _not_allowed(key: str, value: str, allowed: str) -> Fault:
    given = shorten(value)
    return Fault(key, given, f"{given} is not allowed; give {allowed}")
