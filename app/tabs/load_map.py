"""The load map: wheel × time in colours, as HTML with a small picture in it. Pure."""

from __future__ import annotations

from base64 import b64encode
from io import BytesIO

import numpy as np
from PIL import Image

from app.format.load_colours import RAMP, load_colours
from app.format.load_unit import load_unit
from app.format.markup import Html, element, page
from app.format.units import METRIC, Units
from app.plots.curves import at_times
from app.plots.ticks import TICKS, ticks
from model.simulation.trajectory import Trajectory, wheel_names

COLUMNS = 600, 4000  # of a picture at most: about as many as it has pixels on the page, and to be looked at near by
LEAST_TOP = 1e-3  # of a colour bar, in the loads' unit
READING = (
    "Front wheel on top; empty where a wheel is in the air. Bands that slant down to the right pass from the front "
    "wheel to the rear one. Drag to zoom in, double-click to see all."
)


def load_map(run: Trajectory, baseline: Trajectory | None = None, units: Units = METRIC) -> str:
    """HTML of the normal loads of road wheels and of imaginary wheels over time, front wheel on top.

    Where a wheel is in the air the map is empty. A picture's column shows the largest load in its stretch of time. A
    baseline has maps of its own below the run's, in the same colours. The page draws the axis of time, for it zooms.
    """
    if not len(run.t):
        return page(element("p", "This run has no samples."))
    runs = [("", run)] + ([(", baseline", baseline)] if baseline is not None and len(baseline.t) else [])
    maps, unit = [], load_unit(run.system, units)
    for family, letter in (("road", "R"), ("imaginary", "I")):
        shown = []
        for whose, of in runs:
            names = wheel_names(of.system)
            wheels = [w for w, name in enumerate(names) if name.startswith(letter)]
            if wheels:
                load = at_times(run.t, of.t, unit.of(of.normal_load[:, wheels]))
                shown.append((f"Normal load of {family} wheels, {unit.name}{whose}", load, [names[w] for w in wheels]))
        top = max((np.nanmax(load, initial=LEAST_TOP) for _, load, _ in shown), default=LEAST_TOP)
        maps += [(title, load, names, float(top)) for title, load, names in shown]
    rows = sum(len(names) for _, _, names, _ in maps)
    sections = (_map(title, load, names, top, len(names) / rows) for title, load, names, top in maps)
    start, span = float(run.t[0]), max(float(run.t[-1] - run.t[0]), 1e-9)
    all_maps = element("trackride-map", *sections, start=f"{start}", span=f"{span}", style=f"--maps:{len(maps)}")
    return page(all_maps, element("p", READING))


def _map(title: str, load: np.ndarray, names: list[str], top: float, share: float) -> Html:
    """load: (N, K), a column for each name, NaN for unknown; top: of the colours; share: of the height."""
    far, near = (_picture(load, top, columns) for columns in COLUMNS)
    loads = (
        element("span", f"{tick:g}", style=f"bottom:{100 * tick / top:.3f}%")
        for tick in ticks(0.0, top, 2 * TICKS * share)
    )
    pictures = element("img", class_="far", alt=title, src=far), element("img", class_="near", alt="", src=near)
    return element(
        "section",
        element("h4", title),
        element("div", *(element("span", name) for name in names), class_="names"),
        element("div", *pictures, element("i"), element("b"), class_="field"),
        element("div", *loads, class_="bar", style=f"background:linear-gradient(to top, {', '.join(RAMP)})"),
        element("div", class_="times"),
        element("div", "Time, s", class_="axis"),
        class_="trackride-map",
        style=f"--wheels:{len(names)};--share:{share:.4f}",
    )


def _picture(load: np.ndarray, top: float, columns: int) -> str:
    """The map as the address of a PNG picture, a pixel for each wheel and each of at most `columns` times."""
    starts = np.linspace(0, len(load), min(len(load), columns), endpoint=False).round().astype(int)
    highest = np.maximum.reduceat(load, starts, axis=0).T  # (K, columns)
    pixels = load_colours(np.nan_to_num(highest) / top)
    pixels[~(highest > 0), 3] = 0
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "PNG", compress_level=1)  # a third larger, in a quarter of the time
    return f"data:image/png;base64,{b64encode(buffer.getvalue()).decode()}"
