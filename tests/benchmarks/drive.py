"""An hour of Drive at eight times real time, without a browser and without waiting: `python -m tests.benchmarks.drive`.

For less than an hour give the minutes: `python -m tests.benchmarks.drive 10`.

The clock is told that each frame took its time, so that an hour passes as fast as it can be computed. What a frame
takes of the processor is measured: the drive falls behind where that is more than a frame lasts. A slider of the
suspension is moved every minute, and one of the road at every frame for a second of each minute.
"""

from __future__ import annotations

import gc
import resource
import sys
from pathlib import Path
from time import thread_time

import numpy as np

from app.runs.drive import FRAME, Driver
from model import load_config
from model.road.endless import Shapes
from model.road.road import Road, build_road

HOUR = 3600.0  # s
SPEED = 8.0  # times real time
MINUTE = round(60.0 / FRAME)  # frames
DRAG = round(1.0 / FRAME)  # frames that the road is dragged for
JOINS = 30


def measure(seconds: float = HOUR) -> dict[str, tuple[float, str]]:
    """Figures of a drive that lasts so long in real time: name -> (value, unit)."""
    clock = [0.0]
    config = load_config("paper")
    driver = Driver(config, clock=lambda: clock[0])
    took, dragged, drift, sizes = [], [], 0.0, []
    frames = round(seconds / FRAME)
    for k in range(frames):
        clock[0] += FRAME
        into_minute = k % MINUTE
        if into_minute < DRAG:
            amplitude = 0.05 + 0.05 * into_minute / DRAG
            config = config.replace({"road.amplitude": amplitude})
        elif into_minute == MINUTE // 2:
            config = config.replace({"vehicle.road_suspension.damping": 3000.0 + 100.0 * (k // MINUTE)})
        driver.change(config)
        began = thread_time()
        state = driver.frame(SPEED)
        (dragged if into_minute < DRAG else took).append(thread_time() - began)
        if into_minute == MINUTE - 1 or k == frames - 1:
            drift = max(drift, float(state.past.constraint_residual.max()))
            gc.collect()
            sizes.append(memory())
    every = np.array(took + dragged)
    return {
        "simulated": (state.time, "s"),
        "driven": (state.distance / 1e3, "km"),
        "simulated over real time asked for": (state.time / (seconds * SPEED), ""),
        "joints apart at worst": (1e6 * drift, "µm"),
        "computing, of the time there is": (100 * float(every.sum()) / seconds, "%"),
        "a frame, median": (1e3 * float(np.median(took)), "ms"),
        "a frame, 99.9 %": (1e3 * float(np.quantile(took, 0.999)), "ms"),
        "a frame while the road is dragged, median": (1e3 * float(np.median(dragged)), "ms"),
        "a frame while the road is dragged, 99.9 %": (1e3 * float(np.quantile(dragged, 0.999)), "ms"),
        "frames that took longer than they last": (100 * float((every > FRAME).mean()), "%"),
        "memory after the first minute": (sizes[0], "MB"),
        "memory at the end": (sizes[-1], "MB"),
    } | laying()


def laying() -> dict[str, tuple[float, str]]:
    """Processor time of laying the road under the paper's vehicle."""
    paper = load_config("paper")
    wheels = paper.vehicle.road_wheels
    shapes = Shapes.of(build_road(paper))
    figures = {"laying 10 m of road": (_lay(shapes, wheels.radius), "ms")}
    for k in range(JOINS):
        road = build_road(paper.replace({"road.amplitude": 0.1 + 0.001 * k}))
        shapes = shapes.joined(road, 96.0 + k // 3, same_kind=True)
    return figures | {f"laying 10 m in the midst of {JOINS} joins": (_lay(shapes, wheels.radius), "ms")}


def _lay(shapes: Shapes, radius: float) -> float:
    times = []
    for _ in range(20):
        began = thread_time()
        Road(shapes.laid(98.0, 108.0), radius).table  # noqa: B018
        times.append(thread_time() - began)
    return 1e3 * float(np.median(times))


def memory() -> float:
    """Of this process now, MB; where the system does not tell, the most so far."""
    pages = Path("/proc/self/statm")
    if pages.exists():
        return int(pages.read_text().split()[1]) * resource.getpagesize() / 1e6
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


if __name__ == "__main__":
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else HOUR / 60
    for what, (value, unit) in measure(60 * minutes).items():
        print(f"{what:50} {value:10.4g} {unit}")
