"""Files of measured roads with a header of their own: ERD (UMTRI), and OpenCRG (ASAM), as text or binary."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from model.config.profile_points import PointsError

BINARY = {"KRBI": ">f4", "KDBI": ">f8"}  # of OpenCRG, by what follows "#:" in the header …
WIDTHS = {"LRFI": 10, "LDFI": 20}  # … and characters of a number where it is text, in lines of 80


@dataclass(frozen=True)
class Channels:
    """Heights of one or several lines along a road, in equal steps."""

    format: str
    names: list[str]
    units: list[str]
    heights: np.ndarray  # (samples, channels)
    start: float
    step: float
    x_unit: str
    across: np.ndarray | None = None  # m: v of each channel, where they lie side by side on a grid

    def along(self, wanted: str | None) -> tuple[np.ndarray, str, str]:
        """Heights (samples,), name and unit of a channel: by name, number from 1 or "v=0.9". None: the middle, or the
        first where there is no grid. Raises PointsError, which lists the channels.
        """
        if self.across is not None and (wanted is None or wanted.replace(" ", "").lower().startswith("v=")):
            return self._at(0.0 if wanted is None else _number(wanted.split("=")[1], "road.columns"), wanted is None)
        names = [name.lower() for name in self.names]
        if wanted is None:
            number = 0
        elif names.count(wanted.strip().lower()) == 1:
            number = names.index(wanted.strip().lower())
        elif wanted.isdecimal() and 1 <= int(wanted[:9]) <= len(names):
            number = int(wanted) - 1
        else:
            raise PointsError(f"there is no channel {wanted[:40]!r}; there are {', '.join(self.names)[:200]}")
        of = f" of {', '.join(self.names)[:100]} (road.columns chooses)" if len(names) > 1 else ""
        return self.heights[:, number], f"channel {self.names[number]}{of}", self.units[number]

    def _at(self, v: float, unasked: bool) -> tuple[np.ndarray, str, str]:
        across = self.across
        assert across is not None
        if unasked and not across[0] <= v <= across[-1]:
            v = float(across[0] + across[-1]) / 2
        if not across[0] <= v <= across[-1]:
            raise PointsError(f"v = {v:g} m lies off the road, which reaches from {across[0]:g} to {across[-1]:g} m")
        right = int(np.clip(np.searchsorted(across, v), 1, max(len(across) - 1, 1)))
        if len(across) == 1:
            return self.heights[:, 0], f"v = {v:g} m", "m"
        part = (v - across[right - 1]) / (across[right] - across[right - 1])
        one, other = self.heights[:, right - 1], self.heights[:, right]
        if part in (0.0, 1.0):  # not 0 times a height that is missing
            return (one if part == 0.0 else other), f"v = {v:g} m", "m"
        return (1 - part) * one + part * other, f"v = {v:g} m", "m"


def decoded(data: bytes) -> str:
    """A file's text, with lines that end in \\n and minus signs that are hyphens. Raises PointsError."""
    if data.startswith((b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
        raise PointsError("this is a workbook or an archive; save the sheet as CSV")
    encodings = ("utf-16",) if data.startswith((b"\xff\xfe", b"\xfe\xff")) else ("utf-8-sig", "cp1252")
    for encoding in encodings:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\x00" in text:
            break
        text = text.replace("\r\n", "\n").replace("\r", "\n").replace("\u2212", "-").replace("\u00a0", " ")
        return re.sub(r"[\u2012-\u2014](?=[\d.,])", "-", text)
    raise PointsError("the file is no text (UTF-8, UTF-16 or Windows-1252), and no format that is read here")


def is_erd(text: str) -> bool:
    return text.startswith("ERDFILE")


def read_erd(text: str) -> Channels:
    """An ERD file whose numbers are text. Raises PointsError."""
    lines = text.split("\n")
    end = next((k for k, line in enumerate(lines) if line[:8].strip() == "END"), None)
    if end is None or end < 2:
        raise PointsError("ERD: the header has no line END")
    facts = [fact.strip() for fact in lines[1].split(",")]
    if len(facts) < 6:
        raise PointsError(f"ERD, line 2: {len(facts)} entries; give channels, samples, records, bytes, key, step, …")
    if facts[4] != "5":
        raise PointsError(
            f"ERD with numbers that are no text (key {facts[4][:20]!r}); save it with numbers as text (key 5)"
        )
    count, samples = (int(_number(fact, "ERD, line 2")) for fact in facts[:2])
    step = _number(facts[5], "ERD, line 2")
    if not (1 <= count <= 1000 and step > 0.0):
        raise PointsError(f"ERD, line 2: {count} channels in steps of {step:g}; give 1 to 1000, and a step above 0")
    entries = {line[:8].strip().upper(): line[8:] for line in lines[2:end]}
    short, unit = entries.get("SHORTNAM", ""), entries.get("UNITSNAM", "")
    fields = [slice(8 * k, 8 * k + 8) for k in range(count)]
    names = [short[field].strip() or f"channel {k + 1}" for k, field in enumerate(fields)]
    heights = _table(lines[end + 1 :], count, "ERD", end + 2)
    if 0 < samples != len(heights):
        raise PointsError(f"ERD: {len(heights)} samples, where line 2 says {samples}")
    start = _number(entries["XSTART"], "ERD, XSTART") if "XSTART" in entries else 0.0
    return Channels(
        "ERD", names, [unit[field].strip() for field in fields], heights, start, step, entries.get("XUNITS", "")
    )


def is_crg(data: bytes) -> bool:
    return re.search(rb"(?im)^\$(ROAD_CRG|KD_DEFINITION)", data[:100_000]) is not None


def read_crg(data: bytes) -> Channels:
    """An OpenCRG road: its grid of heights, with slope and banking of the reference line added. Raises PointsError."""
    if re.search(rb"(?im)^\$ROAD_CRG_FILE", data[:100_000]):
        raise PointsError("OpenCRG: the header names another file; give that one")
    ends = re.search(rb"(?m)^\${4,}[^\n]*\n", data)
    if ends is None:
        raise PointsError("OpenCRG: the header has no end, a line of $$$$")
    header = data[: ends.start()].decode("latin-1").replace("\r", "")
    lines = [line.partition("!")[0].strip() for line in header.split("\n") if not line.startswith("*")]
    entries = dict(re.findall(r"(?m)^(\w+)\s*=\s*(\S+)", "\n".join(lines).upper()))
    kind = next((line[2:6].upper() for line in lines if line.startswith("#:")), "")
    channels = [line[2:].strip() for line in lines if line.startswith("D:")]
    sections = [k for k, name in enumerate(channels) if name.lower().startswith("long section")]
    if not sections or len(channels) > 10_000:
        raise PointsError("OpenCRG: the header defines no long sections")

    def entry(name: str, default: float) -> float:
        return _number(entries[name], f"OpenCRG, {name}") if name in entries else default

    body = data[ends.end() :]
    if kind in BINARY:
        record = len(channels) * np.dtype(BINARY[kind]).itemsize
        table = (
            np.frombuffer(body[: len(body) // record * record], BINARY[kind]).reshape(-1, len(channels)).astype(float)
        )
    elif kind in WIDTHS:
        table = _fixed(body.decode("latin-1").replace("\r", "").split("\n"), len(channels), WIDTHS[kind])
    else:
        raise PointsError(f"OpenCRG with data of type {kind[:8]!r}; {', '.join([*WIDTHS, *BINARY])} are read")
    start, step = entry("REFERENCE_LINE_START_U", 0.0), entry("REFERENCE_LINE_INCREMENT", 0.0)
    defined = next((re.split(r"\s*,\s*", line) for line in lines if line.startswith("U:")), [])
    if step == 0.0 and len(defined) > 3:
        start, step = (_number(text, "OpenCRG, U") for text in defined[2:4])
    if not step > 0.0:
        raise PointsError("OpenCRG: REFERENCE_LINE_INCREMENT must be above 0")
    if "REFERENCE_LINE_END_U" in entries:  # what follows fills up the last record of a binary file
        table = table[: int(min(max((entry("REFERENCE_LINE_END_U", 0.0) - start) / step + 1.5, 0.0), len(table)))]
    across = _across(channels, sections, entry)
    order = np.argsort(across)
    heights = table[:, sections][:, order]
    slopes = [k for k, name in enumerate(channels) if name.lower().startswith("reference line slope")]
    slope = (
        np.nan_to_num(table[1:, slopes[0]])
        if slopes
        else np.full(max(len(table) - 1, 0), entry("REFERENCE_LINE_START_S", 0.0))
    )
    heights = heights + np.append(0.0, np.cumsum(slope * step))[: len(heights), None]
    if banking := [k for k, name in enumerate(channels) if name.lower().startswith("reference line banking")]:
        heights = heights + np.nan_to_num(table[:, banking]) * across[order]
    names = [f"v={v:g}" for v in across[order]]
    return Channels("OpenCRG", names, ["m"] * len(names), heights, start, step, "m", across[order])


def _across(channels: list[str], sections: list[int], entry: Callable[[str, float], float]) -> np.ndarray:
    """v of the long sections, m."""
    told = [re.search(r"at v\s*=\s*([-+.\dEe]+)", channels[k]) for k in sections]
    if all(told):
        v = np.array([_number(found[1], "OpenCRG, long section") for found in told if found])
    else:
        right = entry("LONG_SECTION_V_RIGHT", np.nan)
        left = entry("LONG_SECTION_V_LEFT", np.nan)
        step = entry("LONG_SECTION_V_INCREMENT", np.nan)
        count = len(sections)
        if np.isnan(step):
            step = (left - right) / max(count - 1, 1) if not np.isnan(left - right) else 0.01
        right = right if not np.isnan(right) else (left - step * (count - 1) if not np.isnan(left) else 0.0)
        v = right + step * np.arange(count)
    if len(np.unique(v)) < len(v):
        raise PointsError("OpenCRG: two long sections lie at the same v")
    return v


def _fixed(lines: list[str], channels: int, width: int) -> np.ndarray:
    """Records of numbers of a fixed width, each from a new line on; *** is a height that is missing."""
    per_line = 80 // width
    used = [line for line in lines if line.strip()]
    per_record = -(-channels // per_line)
    count = len(used) // per_record
    table = np.full((count, channels), np.nan)
    for k in range(count):
        record = "".join(line.ljust(80)[:80] for line in used[k * per_record : (k + 1) * per_record])
        for c in range(channels):
            word = record[c * width : (c + 1) * width].strip()
            if "*" not in word:
                table[k, c] = _number(word, f"OpenCRG, record {k + 1}")
    return table


def _table(lines: list[str], columns: int, format: str, first: int) -> np.ndarray:
    rows = [(number, line.replace(",", " ").split()) for number, line in enumerate(lines, first) if line.strip()]
    for number, words in rows:
        if len(words) != columns:
            raise PointsError(f"{format}, line {number}: {len(words)} numbers; give {columns}")
    return np.array([[_number(word, f"{format}, line {number}") for word in words] for number, words in rows]).reshape(
        -1, columns
    )


def _number(text: str, where: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = np.nan
    if not np.isfinite(number) or "_" in text:
        raise PointsError(f"{where}: {text.strip()[:40]!r} is no number")
    return number
