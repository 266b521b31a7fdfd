"""Runs on disk: what .npz and .csv must hold, and files that are no runs."""

from __future__ import annotations

import csv
import dataclasses
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from model import ConfigError, Trajectory, simulate
from model.config.config_files import parse_config
from model.simulation.trajectory import wheel_names
from tests.model.support import PAPER, WHEELS


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return simulate(PAPER.replace({"simulation.duration": 0.5, "name": "Paper vehicle – half a second"}))


# N = 101 samples, 23 bodies, 11 wheels, 44 rows of C
SHAPES = {
    "t": (101,),
    "q": (101, 23, 3),
    "v": (101, 23, 3),
    "a": (101, 23, 3),
    "normal_load": (101, 11),
    "traction": (101, 11),
    "drive_force": (101,),
    "multipliers": (101, 44),
    "constraint_residual": (101,),
    "static_load": (11,),
}


def test_npz_holds_the_arrays_of_the_result_table(run, tmp_path):
    run.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as file:
        for name, shape in SHAPES.items():
            assert file[name].shape == shape, name
            assert file[name].dtype == np.float64
            np.testing.assert_array_equal(file[name], getattr(run, name))
        assert file["config"].shape == ()
        assert parse_config(str(file["config"])) == run.config
        assert str(file["status"]) == "complete"


def test_shapes_follow_from_the_vehicle(tmp_path):
    config = PAPER.replace(
        {f"{WHEELS}.count": 3, f"{WHEELS}.spacing": 1.4, "drive.mode": "prescribed", "simulation.duration": 0.1}
    )
    run = simulate(config)
    assert run.q.shape == (21, 11, 3)
    assert run.normal_load.shape == (21, 5)
    assert run.multipliers.shape == (21, 2 * 10 + 1)


def test_load_gives_back_what_was_saved(run, tmp_path):
    run.save(tmp_path / "run.npz")
    again = Trajectory.load(tmp_path / "run.npz")
    for field in dataclasses.fields(Trajectory):
        saved, loaded = getattr(run, field.name), getattr(again, field.name)
        if field.name == "tracked":
            for name, value in vars(saved).items():
                np.testing.assert_array_equal(getattr(loaded, name), value)
        elif isinstance(saved, np.ndarray):
            np.testing.assert_array_equal(loaded, saved)
            assert loaded.dtype == saved.dtype
        else:
            assert loaded == saved, field.name


def test_a_run_can_be_repeated_from_its_result(run, tmp_path):
    run.save(tmp_path / "run.npz")
    again = simulate(Trajectory.load(str(tmp_path / "run.npz")).config)
    np.testing.assert_array_equal(again.q, run.q)
    np.testing.assert_array_equal(again.normal_load, run.normal_load)


def test_an_inaccurate_and_a_cancelled_run_keep_their_status(tmp_path):
    apart = simulate(PAPER.replace({"simulation.integrator": "rk4", "simulation.step": 0.05}))
    cancelled = simulate(PAPER, should_stop=lambda: True)
    for run, word in ((apart, "inaccurate at t = "), (cancelled, "cancelled")):
        run.save(tmp_path / "run.npz")
        again = Trajectory.load(tmp_path / "run.npz")
        assert again.status == run.status
        assert again.status.startswith(word)
        assert again.advice == run.advice
        assert not again.complete
        assert len(again.t) == len(again.q) == len(run.t)


def test_a_run_whose_wheels_slip_ever_further_ends_while_it_can_be_loaded_again():
    """Their forces are bounded by friction, so that nothing else shows it."""
    coarse = {"simulation.integrator": "rk4", "simulation.step": 0.01, "simulation.duration": 1}
    soft = {"contact.normal_stiffness": 1.852e6, "contact.normal_damping": 3483, "contact.tangential_damping": 1341.5}
    run = simulate(PAPER.replace(coarse | soft | {"contact.tangential_stiffness": 8e7, "drive.speed_kmh": 12.3}))
    assert run.status.endswith("the state is no longer finite")
    assert np.abs(run.tangential_displacement).max() > 1e6
    again = Trajectory.load(BytesIO(run.to_bytes(".npz")))
    np.testing.assert_array_equal(again.tangential_displacement, run.tangential_displacement)


def test_csv_is_a_table_with_units(run, tmp_path):
    run.save(tmp_path / "run.csv")
    with (tmp_path / "run.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header[:3] == ["t [s]", "hull x [m]", "hull y [m]"]
    assert all(name.endswith("]") for name in header)
    assert len(rows) == 101
    table = dict(zip(header, np.array(rows, dtype=float).T, strict=True))
    for name, values in {
        "t [s]": run.t,
        "hull y [m]": run.q[:, 0, 1],
        "hull pitch [rad]": run.q[:, 0, 2],
        "hull speed [m/s]": run.v[:, 0, 0],
        "hull vertical acceleration [m/s2]": run.a[:, 0, 1],
        "drive force [N]": run.drive_force,
        "normal load R1 [N]": run.normal_load[:, 0],
        "normal load I5 [N]": run.normal_load[:, 10],
        "traction R6 [N]": run.traction[:, 5],
    }.items():
        np.testing.assert_allclose(table[name], values, rtol=1e-8, atol=1e-12)


def test_csv_has_no_minus_before_zero(run):
    backwards = dataclasses.replace(run, traction=-0.0 * np.abs(run.traction))
    assert b"-0," not in backwards.to_bytes(".csv")


def test_bytes_are_the_files_content(run, tmp_path):
    run.save(tmp_path / "run.csv")
    assert run.to_bytes(".csv") == (tmp_path / "run.csv").read_bytes()
    with np.load(BytesIO(run.to_bytes(".npz")), allow_pickle=False) as file:
        np.testing.assert_array_equal(file["q"], run.q)


def test_wheels_are_named_front_first(run):
    assert wheel_names(run.system) == ["R1", "R2", "R3", "R4", "R5", "R6", "I1", "I2", "I3", "I4", "I5"]


@pytest.mark.parametrize("name", ["run.txt", "run", "run.npz.gz", "npz"])
def test_other_suffixes_are_refused(run, tmp_path, name):
    with pytest.raises(ValueError, match=r"\.npz or \.csv"):
        run.save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there(run, tmp_path):
    with pytest.raises(OSError, match="nowhere"):
        run.save(tmp_path / "nowhere" / "run.npz")


@pytest.mark.parametrize("suffix", [".npz", ".csv"])
def test_a_file_is_written_whole_or_not_at_all(run, tmp_path, suffix, full_disk):
    path = tmp_path / f"run{suffix}"
    path.write_bytes(b"what was there before")
    with full_disk(), pytest.raises(OSError, match="File too large"):
        run.save(path)
    assert path.read_bytes() == b"what was there before"
    assert list(tmp_path.iterdir()) == [path]


def test_saving_again_replaces_the_file(run, tmp_path):
    path = tmp_path / "run.npz"
    path.write_bytes(b"something else")
    run.save(path)
    assert Trajectory.load(path).complete
    assert list(tmp_path.iterdir()) == [path]


def parts(run: Trajectory, path: Path) -> dict[str, np.ndarray]:
    """What a run's file holds."""
    run.save(path)
    with np.load(path, allow_pickle=False) as file:
        return dict(file)


def assert_refused(path: Path) -> None:
    with pytest.raises(ValueError, match=r"run\.npz is not a run saved by trackride"):
        Trajectory.load(path)


@pytest.mark.parametrize("kind", ["empty", "text", "cut off", "damaged", "one array", "other arrays"])
def test_files_that_are_no_runs(run, tmp_path, kind):
    path = tmp_path / "run.npz"
    whole = run.to_bytes(".npz")
    one, others = BytesIO(), BytesIO()
    np.save(one, np.zeros(3))
    np.savez(others, x=np.zeros(3))
    damaged = bytearray(whole)
    damaged[len(whole) // 3 : len(whole) // 3 + 400] = bytes(400)
    contents = {
        "empty": b"",
        "text": b"t,q\n1,2\n",
        "cut off": whole[: len(whole) // 2],
        "damaged": bytes(damaged),
        "one array": one.getvalue(),
        "other arrays": others.getvalue(),
    }
    path.write_bytes(contents[kind])
    assert_refused(path)


@pytest.mark.parametrize("missing", ["normal_load", "config", "status", "steps"])
def test_a_run_with_a_part_missing_is_refused(run, tmp_path, missing):
    arrays = parts(run, tmp_path / "run.npz")
    del arrays[missing]
    np.savez(tmp_path / "run.npz", **arrays)
    assert_refused(tmp_path / "run.npz")


def test_nothing_is_unpickled(run, tmp_path):
    arrays = parts(run, tmp_path / "run.npz")
    arrays["q"] = np.array([{"a": 1}], dtype=object)
    np.savez(tmp_path / "run.npz", **arrays)
    assert_refused(tmp_path / "run.npz")


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("q", lambda q: q[:, :5]),
        ("normal_load", lambda load: load[:50]),
        ("static_load", lambda load: load[:3]),
        ("t", lambda t: t[:, None]),
        ("v", lambda v: v.astype(str)),
        ("a", lambda a: np.full_like(a, np.nan)),
        ("multipliers", lambda lam: lam.astype(complex)),
        ("q", lambda q: 1e200 * q),
        ("t", lambda t: t - 1.0),
        ("t", lambda t: t[::-1]),
        ("seconds", lambda seconds: 0.0 * seconds),
        ("seconds", lambda seconds: "long"),
        ("steps", lambda steps: np.nan),
        ("status", lambda status: "complete\n" + status),
        ("status", lambda status: "x" * 10_000),
        ("advice", lambda advice: np.array(["a", "b"])),
    ],
)
def test_arrays_that_do_not_fit_the_configuration_are_refused(run, tmp_path, name, change):
    """A file that was put together by hand must not surprise whoever draws it."""
    arrays = parts(run, tmp_path / "run.npz")
    arrays[name] = change(arrays[name])
    np.savez(tmp_path / "run.npz", **arrays)
    assert_refused(tmp_path / "run.npz")


def test_a_missing_file_and_a_bad_configuration(run, tmp_path):
    with pytest.raises(FileNotFoundError):
        Trajectory.load(tmp_path / "nothing.npz")
    arrays = parts(run, tmp_path / "run.npz")
    arrays["config"] = np.array("vehicle: {wheels: 7}")
    np.savez(tmp_path / "run.npz", **arrays)
    with pytest.raises(ConfigError, match=r"run\.npz: config.*vehicle\.wheels"):
        Trajectory.load(tmp_path / "run.npz")
