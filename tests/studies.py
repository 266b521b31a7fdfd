"""`make studies`: the README's studies, with their pictures for assets/pictures, and how long each took."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from time import perf_counter

from tests.structure import ROOT

PICTURES = ROOT / "assets" / "pictures"
OUT = Path("build") / "studies"
ROAD_SPRING = "vehicle.road_suspension"
STUDIES: dict[str, tuple[str, ...]] = {
    "sensitivity": (
        "paper", "--over", "drive.speed_kmh=10:30", "--over", "road.amplitude=0.05:0.1", "--over",
        f"{ROAD_SPRING}.stiffness=40000:120000", "--over", f"{ROAD_SPRING}.damping=2000:20000",
    ),
    "limits": ("paper", "m113", "marder", "--seeds", "2"),
    "optimise": (
        "random_road", "--minimise", "absorbed_power", "--minimise", "travel", "--over",
        f"{ROAD_SPRING}.stiffness=40000:200000", "--over", f"{ROAD_SPRING}.damping=1000:30000", "--generations", "15",
    ),
    "fit": (
        "m113", "--measured", "assets/links/half_round_100_15.csv", "--set", "road.type=half_round", "--set",
        "road.position=6", "--set", "simulation.duration=4", "--over", f"{ROAD_SPRING}.damping=300:10000", "--over",
        "vehicle.imaginary_suspension.stiffness=1000:200000", "--over", "drive.speed_kmh=12:16", "--low-pass", "20",
    ),
}  # fmt: skip


def command(name: str) -> list[str]:
    """What the shell is given, without the program's name."""
    return [name, *STUDIES[name], "--out", str(OUT / name)]


def main() -> None:
    for name in sys.argv[1:] or STUDIES:
        began = perf_counter()
        subprocess.run([sys.executable, "-m", "app", *command(name)], cwd=ROOT, check=True)
        print(f"{name}: {perf_counter() - began:.1f} s", flush=True)
        shutil.copyfile(ROOT / OUT / name / "figure.png", PICTURES / f"{name}.png")


if __name__ == "__main__":
    main()
