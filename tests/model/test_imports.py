"""The house's rules on who may import whom, read from the source files."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("model", "app", "assets", "configs")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))

# A module imports from rows above its own only. Modules not named stand below all of these.
ROWS = (
    ("model.compiled", "model.files", "model.parameters", "model.yaml_text"),
    ("model.points", "model.road_search"),
    ("model.validation", "model.road_table"),
    ("model.config", "model.profile"),
    ("model.vehicle", "model.shapes", "model.random_road"),
    ("model.suspension", "model.lanes"),
    ("model.road", "model.equilibrium", "model.trajectory"),
    ("model.equations", "model.contact"),
    ("model.kernel",),
    ("model.steppers",),
    ("model.integrate",),
    ("model.simulate",),
    ("model.study",),
)
LEVEL = {module: level for level, row in enumerate(ROWS) for module in row}

# Libraries with a place of their own: the only modules that may import them.
PLACES = {
    "numba": {"model.compiled"},
    "model.compiled": {
        *("model.road_search", "model.road_table", "model.contact", "model.kernel", "model.steppers"),
        *("app.thinning", "app.track"),
    },
    "threading": {"app.session", "app.runner", "app.errands"},
    "queue": set(),
    "_thread": set(),
    "dask": {"model.study"},
    "distributed": {"model.study"},
    "multiprocessing": {"model.study"},
    "trimesh": {"assets.solids"},
}
NOT_IN_MODEL = {"app", "assets", "viser", "threading", "asyncio", "trimesh", "matplotlib", "tkinter", "rich", "typer"}
PURE = (
    "app.scene",
    "app.plots",
    "app.thinning",
    "app.track",
    "app.playback",
    "app.colours",
    "app.ride_plots",
    "app.spectrum_plot",
    "app.comfort_page",
    "app.modes_page",
    "app.mode_show",
    "app.load_map",
    "app.load_colours",
    "app.trust",
    "app.markup",
    "app.status",
    "app.driving",
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
    assert {"model.simulate", "model.kernel", "model.vehicle"} <= set(IMPORTS)
    assert "model.lanes" in IMPORTS["model.kernel"]


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
    for module in [module for module in MODULES if module in PURE or inside(module, "assets")]:
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
