"""The house's rules on who may import whom, read from the source files."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("model", "app", "configs")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

# A module imports from rows above its own only. Modules not named stand below all of these.
ROWS = (
    ("model.compiled", "model.dynamics.ground", "model.files", "model.config.parameters", "model.config.strict_yaml"),
    ("model.config.profile_points", "model.road.nearest_point"),
    ("model.config.validation", "model.road.table"),
    ("model.config.config", "model.road.profile"),
    ("model.dynamics.vehicle", "model.road.shapes", "model.road.random_road"),
    ("model.dynamics.suspension", "model.dynamics.lanes"),
    ("model.road.road", "model.dynamics.equilibrium", "model.simulation.trajectory"),
    ("model.dynamics.equations", "model.dynamics.contact"),
    ("model.dynamics.kernel",),
    ("model.simulation.steppers",),
    ("model.simulation.integrate",),
    ("model.simulation.simulate",),
    ("model.simulation.batch",),
)
LEVEL = {module: level for level, row in enumerate(ROWS) for module in row}

# Libraries with a place of their own: the only modules that may import them.
PLACES = {
    "numba": {"model.compiled"},
    "model.compiled": {
        *(
            "model.road.nearest_point",
            "model.road.table",
            "model.dynamics.contact",
            "model.dynamics.kernel",
            "model.simulation.steppers",
        ),
        *("app.plots.thinning", "app.view3d.track_belt"),
    },
    "threading": {"app.session.session", "app.runs.runner", "app.session.background"},
    "queue": set(),
    "_thread": set(),
    "dask": {"model.simulation.batch"},
    "distributed": {"model.simulation.batch"},
    "multiprocessing": {"model.simulation.batch"},
    "trimesh": {"app.view3d.meshes.solids"},
}
NOT_IN_MODEL = {"app", "assets", "viser", "threading", "asyncio", "trimesh", "matplotlib", "tkinter", "rich", "typer"}
PURE = (
    "app.view3d.snapshot",
    "app.plots.curves",
    "app.plots.thinning",
    "app.view3d.track_belt",
    "app.runs.playback",
    "app.format.colours",
    "app.plots.ride",
    "app.plots.spectrum",
    "app.tabs.comfort",
    "app.tabs.modes",
    "app.view3d.mode_animation",
    "app.tabs.load_map",
    "app.format.load_colours",
    "app.tabs.trust",
    "app.format.markup",
    "app.panels.status_line",
    "app.runs.drive",
)  # no viser, so that they are tested without a browser


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imports(path: Path) -> set[str]:
    """Full names of all modules a file imports, inside functions as well."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            module = node.module or ""
            found |= {
                f"{module}.{alias.name}" if f"{module}.{alias.name}" in MODULES else module for alias in node.names
            }
    return found


MODULES = {name_of(path) for path in SOURCES}
IMPORTS = {name_of(path): imports(path) for path in SOURCES}


def inside(module: str, library: str) -> bool:
    return module == library or module.startswith(f"{library}.")


def test_the_rules_are_about_files_that_exist():
    assert set(LEVEL) <= MODULES
    assert {"model.simulation.simulate", "model.dynamics.kernel", "model.dynamics.vehicle"} <= set(IMPORTS)
    assert "model.dynamics.lanes" in IMPORTS["model.dynamics.kernel"]


@pytest.mark.parametrize("module", [module for module in sorted(MODULES) if inside(module, "model")])
def test_imports_inside_the_model_run_one_way(module):
    level = LEVEL.get(module, len(ROWS))
    for imported in IMPORTS[module] & MODULES:
        if imported in LEVEL or level < len(ROWS):
            assert LEVEL.get(imported, len(ROWS)) < level, f"{module} must not import {imported}"


@pytest.mark.parametrize("module", [module for module in sorted(MODULES) if inside(module, "model")])
def test_the_model_knows_no_viewer_no_thread_no_app(module):
    for imported in IMPORTS[module]:
        assert imported.split(".")[0] not in NOT_IN_MODEL, f"{module} must not import {imported}"


@pytest.mark.parametrize("library", PLACES)
def test_libraries_keep_to_their_places(library):
    users = {module for module, imported in IMPORTS.items() if any(inside(name, library) for name in imported)}
    assert users <= PLACES[library]


def test_pure_parts_of_the_app_and_the_meshes_know_no_viser():
    for module in [module for module in MODULES if module in PURE or inside(module, "app.view3d.meshes")]:
        assert not any(inside(name, "viser") for name in IMPORTS[module]), module


def test_meshes_and_presets_do_not_know_the_app():
    for module in MODULES:
        if not inside(module, "app"):
            assert not any(inside(name, "app") for name in IMPORTS[module]), module


def test_the_model_loads_without_the_app_and_its_libraries():
    program = "import sys, model; print(*{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "model" in loaded
    assert not loaded & {"viser", "app", "assets", "trimesh", "matplotlib", "typer"}
