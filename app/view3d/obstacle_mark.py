"""What draws the eye to an obstacle that the vehicle stands before: a line around it on the road, and its name."""

from __future__ import annotations

import numpy as np
import viser

from app.format.parameters import choice_words
from app.view3d.nodes import Frame
from app.view3d.snapshot import Scene, Snapshot
from model.config.config import Config, SumRoad

COLOUR = (240, 140, 20)
PARTS = 48  # of the line along each edge of the road
LONGEST = 12.0  # m: a longer stretch is no obstacle
LIFT = 0.015  # m from the road up to the line, at the size of the paper's vehicle
LINE = 0.035  # m, thickness of the line
NAME_ABOVE = 0.2  # m from the obstacle's top to its name
OBSTACLE = "/obstacle"  # the node above the others


class ObstacleMark:
    """The mark of one road's obstacle; nothing is drawn where the road has none, or is uneven all along."""

    def __init__(self, api: viser.SceneApi, scene: Scene) -> None:
        self._frame: Frame | None = None
        uneven = scene.ground.road.uneven
        if uneven is None or uneven[1] - uneven[0] > LONGEST:
            return
        self._start, self._end = uneven
        self._frame = Frame(api, OBSTACLE)
        s = scene.measures.scale
        points = outline(scene, self._start, self._end)
        api.add_line_segments(f"{OBSTACLE}/line", points, COLOUR, thickness=LINE * s)
        top = points[..., 2].max() + NAME_ABOVE * s
        middle = (self._end - self._start) / 2, -scene.measures.road_half_width, float(top)
        name = obstacle_name(scene.trajectory.config)
        api.add_label(f"{OBSTACLE}/name", name, position=middle, anchor="bottom-center")
        self._shown = True

    def draw(self, scene: Scene, now: Snapshot) -> None:
        """Bring it to where it is now; it is hidden once the last wheel is behind it."""
        if self._frame is None:
            return
        wheels = now.road_wheels.positions[: scene.system.n, 0] + now.origin
        ahead = bool(wheels.min() - scene.measures.radius <= self._end)
        if ahead != self._shown:
            self._shown = ahead
            self._frame.node.visible = ahead
        self._frame.move(self._start - now.origin)

    def remove(self) -> None:
        if self._frame is not None:
            self._frame.node.remove()


def outline(scene: Scene, start: float, end: float) -> np.ndarray:
    """(K, 2, 3) ends of the lines around a stretch of the road, m; x from its start, on both edges of the road."""
    x = np.linspace(start, end, PARTS + 1)
    edge = np.zeros((PARTS + 1, 3), dtype=np.float32)
    edge[:, 0], edge[:, 2] = x - start, scene.ground.height(x) + LIFT * scene.measures.scale
    right, left = edge.copy(), edge.copy()
    right[:, 1], left[:, 1] = -scene.measures.road_half_width, scene.measures.road_half_width
    along = [np.stack([side[:-1], side[1:]], axis=1) for side in (right, left)]
    across = np.stack([right[[0, -1]], left[[0, -1]]], axis=1)
    return np.concatenate([*along, across])


def obstacle_name(config: Config) -> str:
    """ "Half round"; "Step + bump" where the road has several."""
    road = config.road
    parts = road.parts if isinstance(road, SumRoad) else (road,)
    name = " + ".join(choice_words(part.type) for part in parts)
    return name[:1].upper() + name[1:]
