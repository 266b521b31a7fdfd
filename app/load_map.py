"""The load map: wheel × time in colours, as HTML with a small picture in it. Pure."""

from __future__ import annotations

from base64 import b64encode
from io import BytesIO
from itertools import pairwise

import numpy as np
from PIL import Image

from app.load_colours import RAMP, load_colours
from app.markup import page
from app.plots import at_times
from model.trajectory import Trajectory, wheel_names

COLUMNS = 600  # of the picture at most: about as many as it has pixels on the page
TICKS = 5  # of an axis, at least; twice as many at most
LEAST_TOP = 1e-3  # kN, of a colour bar
READING = (
    "Front wheel on top; empty where a wheel is in the air. Bands that slant down to the right pass from the front "
    "wheel to the rear one."
)


def load_map(run: Trajectory, baseline: Trajectory | None = None) -> str:
    """HTML of the normal loads of road wheels and of imaginary wheels over time, front wheel on top.

    Where a wheel is in the air the map is empty. A picture's column shows the largest load in its stretch of time. A
    baseline has maps of its own below the run's, in the same colours.
    """
    if not len(run.t):
        return page("<p>This run has no samples.</p>")
    runs = [("", run)] + ([(", baseline", baseline)] if baseline is not None and len(baseline.t) else [])
    maps = []
    for family, letter in (("road", "R"), ("imaginary", "I")):
        shown = []
        for whose, of in runs:
            names = wheel_names(of.system)
            wheels = [w for w, name in enumerate(names) if name.startswith(letter)]
            if wheels:
                load = at_times(run.t, of.t, of.normal_load[:, wheels] / 1e3)
                shown.append((f"Normal load of {family} wheels, kN{whose}", load, [names[w] for w in wheels]))
        top = max((np.nanmax(load, initial=LEAST_TOP) for _, load, _ in shown), default=LEAST_TOP)
        maps += [_map(title, run.t, load, names, float(top), 1 / len(runs)) for title, load, names in shown]
    return page(f"{''.join(maps)}<p>{READING}</p>")


def _map(title: str, t: np.ndarray, load: np.ndarray, names: list[str], top: float, height: float) -> str:
    """load: (N, K) kN, a column for each name, NaN for unknown; top: of the colours, kN; height: 1 is the usual."""
    start, span = float(t[0]), max(float(t[-1] - t[0]), 1e-9)
    times = "".join(
        f'<span style="left:{100 * (tick - start) / span:.3f}%">{tick:g}</span>' for tick in ticks(start, start + span)
    )
    loads = "".join(
        f'<span style="bottom:{100 * tick / top:.3f}%">{tick:g}</span>' for tick in ticks(0.0, top, TICKS * height)
    )
    return (
        f'<section class="trackride-map" style="--wheels:{len(names)};--height:{height:g}"><h4>{title}</h4>'
        f'<div class="names">{"".join(f"<span>{name}</span>" for name in names)}</div>'
        f'<div class="field"><img alt="{title}" src="{_picture(load, top)}">'
        f'<i style="left:calc(100% * (var(--trackride-now, -1) - {start:g}) / {span:g})"></i></div>'
        f'<div class="bar" style="background:linear-gradient(to top, {", ".join(RAMP)})">{loads}</div>'
        f'<div class="times">{times}</div><div class="axis">Time, s</div></section>'
    )


def ticks(low: float, high: float, least: float = TICKS) -> list[float]:
    """Round numbers from low to high, `least` of them or a few more, in steps of 1, 2 or 5 times a power of ten."""
    rough = (high - low) / least
    power = 10.0 ** np.floor(np.log10(rough))
    step = max(factor * power for factor in (1.0, 2.0, 5.0) if factor * power <= rough * (1 + 1e-9))
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [float(round(k * step, 9)) + 0.0 for k in np.arange(first, last + 1)]


def _picture(load: np.ndarray, top: float) -> str:
    """The map as the address of a PNG picture, a pixel for each wheel and stretch of time."""
    edges = np.linspace(0, len(load), min(len(load), COLUMNS) + 1).round().astype(int)
    highest = np.array([load[i:k].max(axis=0) for i, k in pairwise(edges)]).T  # (K, columns)
    pixels = load_colours(np.nan_to_num(highest) / top)
    pixels[~(highest > 0), 3] = 0
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG")
    return f"data:image/png;base64,{b64encode(buffer.getvalue()).decode()}"
