"""A stamped figure to take home: one page with picture, plots, ride figures and every parameter, as PNG or SVG."""

from __future__ import annotations

import io
from collections.abc import Sequence
from datetime import datetime

import numpy as np
from matplotlib.axes import Axes
from PIL import Image

from app.format.colours import Palette, wheel_palette
from app.format.load_unit import LoadUnit, comparison_rows, load_unit
from app.plots.curves import beside_loads, load_plots
from app.plots.ride import ride_plots
from app.reports.drawings import AxesStyle, file_of, mark_peaks, plain_axes, stamp
from app.reports.sheet_page import ALARM, GREY, HEIGHT, INK, LOOK, MARGIN, WIDTH, Sheet, plain
from app.reports.sheet_tables import Tables
from app.reports.side_view import draw_side_view, highest_load
from model.analysis.ride_warnings import warnings
from model.analysis.signals import window
from model.simulation.trajectory import Trajectory, wheel_names

LEFT, RIGHT = 5.25, 5.2  # inches, like all lengths: widths of the columns, picture and plots; tables
PICTURE = 2.6  # height
NAMED = 10  # curves of one plot, at most
STYLE = AxesStyle(
    title=7.2, names=6.8, numbers=6.4, above=3.0, to_name=2.0, to_number=2.0, tick=2.0, line=0.5, grid=0.5
)  # of the plots
HULL = "Hull"  # the curve of its acceleration
TOP, BOTTOM = HEIGHT - 1.17, 0.5  # of the columns
MODEL = "Half a vehicle, plane motion, the track as imaginary wheels after Mahalingam & Padmanabhan; loads of one side."


def stamped_figure(
    trajectory: Trajectory,
    baseline: Trajectory | None,
    picture: bytes | None,
    title: str,
    suffix: str,
    time: float | None = None,
) -> bytes:
    """The sheet as a ".png" or ".svg" file: A4, landscape. May be called on any thread.

    picture: PNG or JPEG of the scene at `time`, s, which is then marked in the plots. Without a picture the vehicle is
    drawn from its side, without a time at that of the highest wheel load. Raises ValueError for another suffix.
    """
    if suffix not in (".png", ".svg"):
        raise ValueError(f"a figure cannot be saved as {suffix}: only as .png or .svg")
    sheet = compose(trajectory, baseline, picture, title, time)
    return file_of(sheet.figure, title, suffix)


def compose(
    trajectory: Trajectory,
    baseline: Trajectory | None,
    picture: bytes | None,
    title: str,
    time: float | None = None,
) -> Sheet:
    """The sheet that `stamped_figure` saves."""
    sheet, palette = Sheet(), wheel_palette(trajectory.system.n, trajectory.system.m)
    if time is None and picture is None:
        time = highest_load(trajectory)
    _head(sheet, trajectory, baseline, title)
    _picture(sheet, trajectory, picture, palette, time)
    _plots(sheet, trajectory, baseline, palette, time)
    colours = dict(zip(wheel_names(trajectory.system), palette.wheels, strict=True))
    tables = Tables(sheet, WIDTH - MARGIN - RIGHT, TOP - 0.06, BOTTOM, RIGHT)
    reference = None if baseline is None else baseline.config
    rows = comparison_rows(trajectory, baseline)
    tables.draw(rows, window(trajectory), colours, trajectory.config, reference)
    _foot(sheet, trajectory)
    return sheet


def _head(sheet: Sheet, trajectory: Trajectory, baseline: Trajectory | None, title: str) -> None:
    right, y = WIDTH - MARGIN, HEIGHT - 0.65
    sheet.write(MARGIN, y, plain(title, 72), 15, weight="bold")
    sheet.write(right, y + 0.1, stamp(), 8, weight="bold", ha="right")
    sheet.write(right, y - 0.06, datetime.now().strftime("%Y-%m-%d %H:%M"), 8, color=GREY, ha="right")
    words = plain(trajectory.config.name, 50)
    if baseline is not None:
        other = plain(baseline.config.name, 50)
        which = "" if other == words else f", {other}"
        words = f"{words}.   Solid lines: this run; pale dashed lines: the baseline{which}."
    sheet.write(MARGIN, y - 0.22, words, 8.5, color=GREY)
    sheet.rule(MARGIN, y - 0.32, WIDTH - 2 * MARGIN, INK, 0.01)


def _foot(sheet: Sheet, trajectory: Trajectory) -> None:
    sheet.write(MARGIN, 0.27, MODEL, 6.2, color=GREY)
    cautions = [] if trajectory.complete else [f"the run is not complete: {trajectory.status}"]
    cautions += [warning.what for warning in warnings(trajectory)]
    if cautions:
        sheet.write(WIDTH - MARGIN, 0.27, plain(f"Mind: {'; '.join(cautions)}", 105), 6.2, color=ALARM, ha="right")


def _picture(sheet: Sheet, trajectory: Trajectory, picture: bytes | None, palette: Palette, time: float | None) -> None:
    axes = sheet.axes(MARGIN, TOP - PICTURE, LEFT, PICTURE)
    if picture is not None:
        axes.imshow(np.asarray(Image.open(io.BytesIO(picture)).convert("RGB")), interpolation="lanczos")
        axes.set_axis_off()
    else:
        assert time is not None
        draw_side_view(axes, trajectory, palette, time)
    if time is not None:
        words = f"t = {time:.2f} s" + ("; arrows: normal loads" if picture is None else "")
        sheet.write(MARGIN, TOP + 0.02, words, 6.2, color=GREY)


def _plots(
    sheet: Sheet, trajectory: Trajectory, baseline: Trajectory | None, palette: Palette, time: float | None
) -> None:
    """Loads of road wheels and of imaginary wheels, if there are any, and the hull's acceleration, over time."""
    names = wheel_names(trajectory.system)
    n, unit = trajectory.system.n, load_unit(trajectory.system)
    plots: list[tuple[str, Sequence[str], Sequence[str]]] = [
        ("Vertical acceleration of the hull, m/s²", [HULL], [palette.hull]),
        (f"Normal load of imaginary wheels, {unit.name}", names[n:], palette.imaginary),
        (f"Normal load of road wheels, {unit.name}", names[:n], palette.road),
    ]
    plots = [plot for plot in plots if plot[1]]
    peaks = {
        plot.curves[peak.curve].label: peak
        for plot in (*load_plots(trajectory, palette), *ride_plots(trajectory, palette))
        for peak in plot.peaks
    }
    foot, between, indent = BOTTOM + 0.26, 0.3, 0.4
    height = (TOP - PICTURE - 0.32 - foot - between * (len(plots) - 1)) / len(plots)
    for k, (title, labels, colours) in enumerate(plots):
        axes = sheet.axes(MARGIN + indent, foot + k * (height + between), LEFT - indent, height)
        other = baseline if labels == [HULL] else beside_loads(trajectory, baseline)
        if other is not None:
            _draw(axes, other, unit, labels, colours, lw=0.7, alpha=0.5, dashes=(3, 1.5))
        _draw(axes, trajectory, unit, labels, colours, lw=0.8)
        axes.margins(y=0.06)
        marked = [(peaks[label], colour) for label, colour in zip(labels, colours, strict=True) if label in peaks]
        mark_peaks(axes, marked, LOOK, 2.5, STYLE.numbers)
        plain_axes(axes, LOOK, title, "Time, s" if k == 0 else "", style=STYLE)
        axes.set_xlim(0, max(float(trajectory.t[-1]), 1e-3))
        if time is not None:
            axes.axvline(time, color=GREY, lw=0.7, ls=(0, (1, 1.5)))
        if len(labels) > 1:
            _name(axes, labels, colours)
        axes.tick_params(labelbottom=k == 0)


def _draw(
    axes: Axes, run: Trajectory, unit: LoadUnit, labels: Sequence[str], colours: Sequence[str], **style: object
) -> None:
    """The curves of those names that the run has, loads in that unit."""
    curves = dict(zip(wheel_names(run.system), unit.of(run.normal_load.T), strict=True))
    curves[HULL] = run.a[:, run.system.chassis, 1]
    for label, colour in zip(labels, colours, strict=True):
        if label in curves:
            axes.plot(run.t, curves[label], color=colour, **style)  # type: ignore[arg-type]


def _name(axes: Axes, labels: Sequence[str], colours: Sequence[str]) -> None:
    """The curves' names in their colours, in line with the title; of many only as many as there is room for."""
    named = np.linspace(len(labels) - 1, 0, min(len(labels), NAMED)).round().astype(int)
    for place, k in enumerate(named):
        axes.text(
            1 - 0.055 * place,
            1.035,
            labels[k],
            transform=axes.transAxes,
            ha="right",
            fontsize=6.6,
            color=colours[k],
            weight="bold",
        )
