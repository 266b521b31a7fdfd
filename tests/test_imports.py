"""The house's rules on who may import whom. Imports are followed through, those for typing included."""

from __future__ import annotations

import subprocess
import sys
from html import unescape

import pytest

from tests.structure import FLOOR, IMPORTS, MODULES, PICTURE, ROOT, arrows, chain, circles, content, inside, room_of

# Libraries with a place of their own: exactly these modules, or modules in these packages, import them.
PLACES = {
    "numba": {"model.compiled"},
    "model.compiled": {
        *("model.road.nearest_point", "model.road.table", "model.road.thinning"),
        *("model.dynamics.kernel_contact", "model.dynamics.kernel"),
        *(
            "model.simulation.dense",
            "model.simulation.extremes",
            "model.simulation.flanks",
            "model.simulation.steppers",
        ),
        *("app.plots.thinning", "app.view3d.track_belt"),
    },
    "threading": {
        *("app.server", "app.session.session", "app.session.background"),
        *("app.runs.runner", "app.runs.turns", "app.commands.common"),
    },
    "concurrent": {"model.simulation.batch"},
    "matplotlib": {"app.reports"},
    "pyarrow": {"model.study.table"},
    "scipy.stats": {"model.study.design", "model.study.sensitivity", "model.study.fit"},
    "trimesh": {"app.view3d.meshes.solids"},
    "distributed": {"model.study.cluster"},
    **{nowhere: set() for nowhere in ("_thread", "queue", "multiprocessing", "dask", "optuna")},
}
NOT_IN_MODEL = ("app", "viser", "threading", "asyncio", "trimesh", "matplotlib", "tkinter", "rich", "typer")
# What loads no viser, so that it serves without a browser and is tested without one
NO_VISER = ("model", "app.format", "app.plots", "app.runs", "app.tabs", "app.reports", "app.view3d.meshes")
NO_VISER += (
    "app.commands",
    "app.view3d.snapshot",
    "app.view3d.track_belt",
    "app.view3d.mode_animation",
    "app.panels.status_line",
)


def modules_in(package: str) -> list[str]:
    return [module for module in MODULES if inside(module, package)]


@pytest.mark.parametrize("room", sorted(arrows()))
def test_rooms_import_from_floors_below_their_own(room):
    package = room.split(".")[0]
    for imported in arrows()[room]:
        assert FLOOR[imported] < FLOOR[room], f"{room} must not import {imported}"
        assert inside(imported, package) or package == "app", f"{room} must not import {imported}"


def test_every_module_is_in_a_room_or_has_a_reason_not_to_be():
    outside = {module for module in MODULES if room_of(module) is None}
    assert outside == {"model", "model.compiled", "model.files", "app", "app.__main__", "configs"}


@pytest.mark.parametrize("module", ["model.compiled", "model.files", "configs"])
def test_what_all_may_import_imports_nothing_of_ours(module):
    assert not IMPORTS[module] & MODULES.keys()


def test_rooms_of_the_model_do_not_import_what_it_offers_to_others():
    assert not [module for module in modules_in("model") if "model" in IMPORTS[module]]


def test_no_modules_import_each_other():
    assert circles() == []


@pytest.mark.parametrize("package", ["model", "app"])
def test_few_files_lie_directly_in_a_package(package):
    assert len([path for path in (ROOT / package).iterdir() if path.is_file()]) <= 6


def test_assets_hold_no_python():
    assert not list((ROOT / "assets").rglob("*.py"))


@pytest.mark.parametrize("library", NOT_IN_MODEL)
def test_the_model_knows_no_viewer_no_thread_no_app(library):
    for module in modules_in("model"):
        assert not (way := chain(module, library)), " → ".join(way)


@pytest.mark.parametrize("library", PLACES)
def test_libraries_keep_to_their_places(library):
    users = {module for module, imported in IMPORTS.items() if any(inside(name, library) for name in imported)}
    places = PLACES[library]
    assert {place for place in places if any(inside(user, place) for user in users)} == places
    assert not {user for user in users if not any(inside(user, place) for place in places)}


@pytest.mark.parametrize("package", NO_VISER)
def test_no_way_leads_to_viser(package):
    assert modules_in(package)
    for module in modules_in(package):
        assert not (way := chain(module, "viser")), " → ".join(way)


def test_viser_is_not_loaded():
    assert "viser" not in loaded_by([module for package in NO_VISER for module in modules_in(package)])


def test_the_model_loads_without_the_app_and_its_libraries():
    loaded = loaded_by(modules_in("model"))
    assert "model" in loaded
    assert not loaded & {"viser", "app", "trimesh", "matplotlib", "typer", "rich"}


@pytest.mark.parametrize("module", ["model", "app.cli", "app.server"])
def test_libraries_of_studies_are_loaded_by_studies_only(module):
    assert not loaded_by([module]) & {"pyarrow", "distributed", "dask", "optuna"}


def loaded_by(modules: list[str]) -> set[str]:
    """Top-level names of all that a fresh Python loads with these modules."""
    program = f"import sys, {', '.join(modules)}; print(*{{name.split('.')[0] for name in sys.modules}})"
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_the_cache_of_compiled_code_heeds_all_files_with_such_code():
    """Compiled functions, and those that they compile in from modules that they import."""
    from model.compiled import _KERNELS

    users = [module for module in modules_in("model") if "model.compiled" in IMPORTS[module]]
    with_code = {*users, *(name for user in users for name in IMPORTS[user] & MODULES.keys())}
    assert with_code <= {f"model.{name.removesuffix('.py').replace('/', '.')}" for name in _KERNELS}


def test_the_picture_of_the_rooms_is_current():
    assert content() in unescape(PICTURE.read_text(encoding="utf-8")), "run: make structure"
