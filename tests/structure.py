"""Who imports whom, read from the source files. `make structure` draws it: assets/pictures/structure.svg.

A room is a folder of model/ or app/, or a file that lies directly in app/. Imports count wherever they stand: inside
functions and for typing too.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "assets" / "pictures" / "structure.svg"
PACKAGES = ("model", "app", "configs")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

# The rooms, lowest floor first. A room imports from floors below its own, and app from model, but never the reverse.
MODEL = ("config", "road", "dynamics", "simulation", "analysis", "study", "paper")
APP = (
    ("format",),
    ("plots", "view3d", "runs"),
    ("tabs", "files"),
    ("panels", "reports"),
    ("session", "web", "commands"),
    ("server",),
    ("cli",),
)
FLOOR = {f"model.{room}": floor for floor, room in enumerate(MODEL)} | {
    f"app.{room}": floor for floor, rooms in enumerate(APP, len(MODEL)) for room in rooms
}


def name_of(path: Path) -> str:
    """The module's full name."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


MODULES = {name_of(path): path for path in SOURCES}


def _imports(path: Path) -> set[str]:
    """Full names of all modules that a file imports."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            full = {alias.name: f"{node.module}.{alias.name}" for alias in node.names}
            found |= {full[name] if full[name] in MODULES else str(node.module) for name in full}
    return found


IMPORTS = {name: _imports(path) for name, path in MODULES.items()}


def inside(module: str, package: str) -> bool:
    """Whether a module is this one, or in this package."""
    return module == package or module.startswith(f"{package}.")


def chain(module: str, library: str) -> list[str]:
    """The shortest way by which a module comes to load a library: module, …, library; empty if there is none.

    Loading a module loads the packages that it is in as well.
    """
    came_from: dict[str, str] = {module: ""}
    row = [module]
    for name in row:  # it grows meanwhile
        if inside(name, library):
            way = [name]
            while came_from[way[0]]:
                way.insert(0, came_from[way[0]])
            return way
        for imported in sorted(IMPORTS.get(name, ())):
            parts = imported.split(".")
            for loaded in (".".join(parts[: k + 1]) for k in range(len(parts))):
                if loaded not in came_from:
                    came_from[loaded] = name
                    row.append(loaded)
    return []


def circles() -> list[set[str]]:
    """Modules that import each other, directly or through others."""
    reached = {module: set(_followed(module)) for module in MODULES}
    rings = ({other for other in reached[module] if module in reached[other]} for module in MODULES)
    return [set(ring) for ring in {frozenset(ring) for ring in rings if ring}]


def _followed(module: str) -> Iterator[str]:
    """All modules of ours that a module imports, directly or through others."""
    found, row = set(), [module]
    while row:
        for imported in IMPORTS[row.pop()] & MODULES.keys() - found:
            found.add(imported)
            row.append(imported)
            yield imported


def room_of(module: str) -> str | None:
    """The room that a module is in; None for what lies directly in model/, for `python -m app`, and for configs."""
    room = ".".join(module.split(".")[:2])
    return room if room in FLOOR else None


def arrows() -> dict[str, set[str]]:
    """room -> rooms from which it imports."""
    found: dict[str, set[str]] = {}
    for module, imported in IMPORTS.items():
        room = room_of(module)
        if room is not None:
            found.setdefault(room, set()).update({room_of(name) for name in imported} - {room, None})
    return found


def drawn_arrows() -> dict[str, list[str]]:
    """The same without arrows that others imply, and without those from app to model, which are one in the picture."""
    every = {
        room: {to for to in imported if inside(to, room.split(".")[0])} for room, imported in sorted(arrows().items())
    }

    def below(room: str) -> set[str]:
        lower = {to for to in every[room] if FLOOR[to] < FLOOR[room]}
        return lower.union(*(below(to) for to in lower))

    implied = {room: set().union(*(below(to) for to in every[room] if FLOOR[to] < FLOOR[room])) for room in every}
    return {room: sorted(every[room] - implied[room]) for room in every}


def caption(room: str) -> str:
    """First sentence of a room's docstring."""
    text = ast.get_docstring(ast.parse(MODULES[room].read_text(encoding="utf-8"))) or ""
    return text.split("\n")[0].partition(". ")[0].rstrip(".").removesuffix("; no viser")


def content() -> str:
    """What the picture shows, as text. It is kept in the picture, so that a test can tell whether that is current."""
    return "; ".join(f"{room} ({caption(room)}) → {', '.join(to) or '–'}" for room, to in drawn_arrows().items())


# ── The picture ──

SIZE = 10.0, 9.55  # inches
INK, LINE = "#1f2933", "#52606d"
LIGHT = {"app": ("#e8f1fb", "#3b7dbd"), "model": ("#e9f6ed", "#3d8b57")}  # fill, edge
FRAME = {"app": (0.1, 2.55, 9.8, 6.9), "model": (0.1, 0.1, 9.8, 2.05)}  # left, bottom, width, height
BOX = {"app": (2.25, 0.82), "model": (1.29, 1.45)}  # width, height
# The middles of app's rooms from left to right and from below; those of model's stand in a row
PLACES = {
    "format": (4.5, 0),
    "runs": (1.5, 1),
    "plots": (4.5, 1),
    "view3d": (8.5, 1),
    "tabs": (4.5, 2),
    "files": (7.05, 2),
}
PLACES |= {"panels": (3.2, 3), "reports": (8.5, 3), "session": (2.4, 4), "web": (5.4, 4), "commands": (8.5, 4)}
PLACES |= {"server": (3.2, 5), "cli": (8.5, 5)}


def draw() -> None:
    """Write the picture."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context({"svg.hashsalt": "structure", "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=SIZE, facecolor="white")
        axes = figure.add_axes((0, 0, 1, 1), xlim=(0, SIZE[0]), ylim=(0, SIZE[1]))
        axes.axis("off")
        for package, (left, bottom, width, height) in FRAME.items():
            _box(axes, (left, bottom, width, height), "#fbfcfd", "#c3cdd8")
            axes.text(left + 0.15, bottom + height - 0.3, f"{package}/", size=13, weight="bold", color=INK)
        note = "An arrow: imports. What follows from other arrows is left out."
        axes.text(9.75, 9.18, note, size=8.5, color=LINE, ha="right")
        axes.annotate("", (5.0, 2.15), (5.0, 2.55), arrowprops=_arrow(3.0))
        for room, imported in drawn_arrows().items():
            _room(axes, room)
            for other in imported:
                axes.annotate("", *_ends(room, other), arrowprops=_arrow(1.4))
        figure.savefig(PICTURE, metadata={"Date": None, "Description": content()})


def _arrow(width: float) -> dict[str, object]:
    return {
        "arrowstyle": "-|>",
        "color": LINE,
        "linewidth": width,
        "mutation_scale": 9 + 3 * width,
        "shrinkA": 0,
        "shrinkB": 1,
    }


def _middle(room: str) -> tuple[float, float]:
    package, _, name = room.partition(".")
    if package == "model":
        rooms = [f"model.{name}" for name in MODEL if f"model.{name}" in MODULES]
        step = (FRAME["model"][2] - 0.1) / len(rooms)
        return 0.15 + step * (rooms.index(room) + 0.5), 0.93
    x, floor = PLACES[name]
    return x, 3.05 + 1.1 * floor


def _ends(room: str, other: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Where the arrow from a room to another ends, and where it begins."""
    (x, y), (to_x, to_y) = _middle(room), _middle(other)
    half, tall = (size / 2 for size in BOX[room.partition(".")[0]])
    if y == to_y:
        side = half if to_x > x else -half
        return (to_x - side, y), (x + side, y)
    down = tall if to_y < y else -tall
    return (to_x + 0.35 * _sign(x - to_x), to_y + down), (x + 0.35 * _sign(to_x - x), y - down)


def _sign(x: float) -> int:
    return (x > 0) - (x < 0)


def _room(axes: Axes, room: str) -> None:
    package, _, name = room.partition(".")
    (x, y), (width, height) = _middle(room), BOX[package]
    _box(axes, (x - width / 2, y - height / 2, width, height), *LIGHT[package])
    what = f"{name}.py" if MODULES[room].stem == name else f"{name}/"
    axes.text(x, y + height / 2 - 0.09, what, size=10.5, weight="bold", color=INK, ha="center", va="top")
    text = fill(caption(room).replace("`", ""), 36 if package == "app" else 20)
    axes.text(x, y + height / 2 - 0.32, text, size=8, color=INK, ha="center", va="top", linespacing=1.25)


def _box(axes: Axes, place: tuple[float, float, float, float], face: str, edge: str) -> None:
    from matplotlib.patches import FancyBboxPatch

    left, bottom, width, height = place
    style = "round,pad=0,rounding_size=0.08"
    axes.add_patch(FancyBboxPatch((left, bottom), width, height, boxstyle=style, facecolor=face, edgecolor=edge))


if __name__ == "__main__":
    draw()
