"""Numbers and lists as the page about the paper writes them; plain text."""

from __future__ import annotations

from collections.abc import Sequence

HARDLY = 0.05  # relative change that counts as hardly any


def change_words(change: float) -> str:
    """A relative change in percent, with its sign: "−9.1 %"."""
    text = f"{100 * change:+.1f}" if abs(change) < 0.0995 else f"{100 * change:+.0f}"
    return f"{'±0' if float(text) == 0 else text.replace('-', '−')} %"


def share_words(part: float) -> str:
    """A share in percent: "7.2 %", "47 %"."""
    return f"{100 * part:.1f} %" if 0 < part < 0.0995 else f"{100 * part:.0f} %"


def length_words(metres: float) -> str:
    """A small length: "4.7 nm", "30 µm", "1.6 mm"."""
    factor, unit = next((f, u) for f, u in ((1e3, "mm"), (1e6, "µm"), (1e9, "nm")) if f * metres >= 0.1 or u == "nm")
    return f"{factor * metres:.2g} {unit}"


def list_words(words: Sequence[str]) -> str:
    """ "a, b and c"."""
    return " and ".join(part for part in (", ".join(words[:-1]), words[-1]) if part)
