"""A small side view of the road about the vehicle, its heights exaggerated, as HTML. Pure."""

from __future__ import annotations

import numpy as np

from app.format.markup import element
from app.format.units import METRIC, Units
from app.plots.ticks import ticks
from model.config.config import Config
from model.road.road import Road
from model.simulation.trajectory import Trajectory

BEHIND, AHEAD = 10.0, 30.0  # m of road about the hull's centre of mass
WIDTH, HEIGHT = 400, 84  # of the drawing
FOOT = 16  # of it, for the distances
HEADROOM = 8  # of it, for wheels on the highest point
MARGIN = 2.0  # m from its ends within which a distance's text would be cut
LINE = 201  # points of the road
LEAST_SPAN = 0.2  # m of height that are always in view


class RoadAhead:
    """The side view of one tab. It keeps what stays the same from one instant to the next."""

    def __init__(self) -> None:
        self._config: Config | None = None  # whose road is that of a run
        self._road: Road | None = None
        self._run: Trajectory | None = None
        self._span = (0.0, 0.0)

    def of_run(self, run: Trajectory, time: float, units: Units = METRIC) -> str:
        """HTML of the view at a time of a run with samples, s."""
        if self._road is None or self._config is None or not _same_road(self._config, run.config):
            self._config, self._road, self._run = run.config, run.road, None
        if self._run is not run:
            x = run.q[:, run.system.chassis, 0]
            self._run, self._span = run, span_of(self._road, float(x.min()), float(x.max()))
        return _at(run, self._road, self._span, time, units)

    def of_drive(self, recent: Trajectory, road: Road, time: float, units: Units = METRIC) -> str:
        """HTML of the view at a time of a drive, s, on the road that is laid."""
        if self._road is None or self._road.profile is not road.profile:
            x = float(recent.q[-1, recent.system.chassis, 0])
            self._config, self._run, self._span = None, None, span_of(road, x, x)
        self._road = road
        return _at(recent, road, self._span, time, units)


def _same_road(one: Config, other: Config) -> bool:
    return one.road == other.road and one.vehicle.road_wheels == other.vehicle.road_wheels


def _at(run: Trajectory, road: Road, span: tuple[float, float], time: float, units: Units) -> str:
    x = run.q[min(int(np.searchsorted(run.t, time)), len(run.t) - 1), :, 0]
    return road_view(road, span, float(x[run.system.chassis]), x[run.system.road_wheels], units)


def span_of(road: Road, first: float, last: float) -> tuple[float, float]:
    """Heights to show, m, for a drive from `first` to `last`, m: the same all along it."""
    h = road.height(np.linspace(first - BEHIND, last + AHEAD, 4000))
    low, high = float(h.min()), float(h.max())
    middle, half = (low + high) / 2, max(high - low, LEAST_SPAN) / 2
    return middle - 1.1 * half, middle + 1.1 * half


def road_view(road: Road, span: tuple[float, float], x: float, wheels: np.ndarray, units: Units = METRIC) -> str:
    """HTML of the road's heights within the span, m, about x, m, and of wheels at these x (K,), m."""
    low, high = span
    along = x + np.linspace(-BEHIND, AHEAD, LINE)
    height = np.clip(road.height(along), low, high)
    line = " ".join(f"{_across(a, x):.1f},{b:.1f}" for a, b in zip(along, _up(height, span), strict=True))
    under = np.clip(road.height(wheels), low, high)
    dots = (
        element("circle", cx=f"{_across(wheel, x):.1f}", cy=f"{at - 3:.1f}", r="3")
        for wheel, at in zip(wheels, _up(under, span), strict=True)
    )
    unit = units.of("m")
    distances = (
        element("text", f"{tick:g}{unit.after}", x=f"{_across(tick / unit.factor, x):.1f}", y=f"{HEIGHT - 3}")
        for tick in ticks((x - BEHIND) * unit.factor, (x + AHEAD) * unit.factor, 4)
        if x - BEHIND + MARGIN <= tick / unit.factor <= x + AHEAD - MARGIN
    )
    exaggeration = (HEIGHT - FOOT - HEADROOM) / (high - low) * (BEHIND + AHEAD) / WIDTH
    drawing = element(
        "svg",
        element("polygon", points=f"0,{HEIGHT - FOOT} {line} {WIDTH},{HEIGHT - FOOT}"),
        element("polyline", points=line),
        *dots,
        *distances,
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        role="img",
        aria_label="Road ahead",
    )
    caption = element("figcaption", f"Road ahead, heights enlarged {exaggeration:.2g} times")
    return str(element("figure", drawing, caption, class_="trackride-road"))


def _across(at: float, x: float) -> float:
    """A place along the road, m, in the drawing about x, m, from its left edge."""
    return (at - x + BEHIND) / (BEHIND + AHEAD) * WIDTH


def _up(height: np.ndarray, span: tuple[float, float]) -> np.ndarray:
    """Heights, m, in the drawing, from its top."""
    low, high = span
    return (high - height) / (high - low) * (HEIGHT - FOOT - HEADROOM) + HEADROOM
