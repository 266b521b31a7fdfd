"""What is read beside the plots: spectrum, load map, trust, about."""

from __future__ import annotations

import re
from base64 import b64decode
from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from app.format.differences import figure_text
from app.format.load_colours import RAMP, load_colours
from app.format.load_unit import load_unit
from app.format.markup import formula_html
from app.format.units import US
from app.panels.plot_page import marks_html
from app.panels.wheel_card import card
from app.plots.spectrum import Mark, named, spectrum_plot
from app.tabs.about import LAWS, about_html
from app.tabs.comfort import COMFORT_FIGURES, comfort_headline, comfort_page
from app.tabs.load_map import load_map
from app.tabs.modes import BY_ALL, BY_NOTHING, excited, mode_titles, modes_page, response
from app.tabs.trust import balances, drift, errata_html, trust_html
from model import load_config, simulate
from model.analysis.comfort import ride_comfort
from model.analysis.modes import Mode, Modes, vehicle_modes
from model.analysis.signals import CENTRE_OF_MASS, seat
from model.analysis.spectrum import excitation
from model.analysis.wheel_contact import wheel_state
from model.config.parameters import GROUPS, NOTES, PARAMETERS
from model.paper.errata import ERRATA
from model.simulation.trajectory import Trajectory
from tests.app.conftest import make_run

PAPER = load_config("paper")
MODES = vehicle_modes(PAPER)
MARKS = named(excitation(PAPER), MODES)


@pytest.fixture(scope="module")
def run() -> Trajectory:
    return simulate(PAPER)


def pictures(text: str, kind: str = "far") -> list[np.ndarray]:
    """Pixels of a load map's pictures of this kind, RGBA."""
    found = re.findall(rf'class="{kind}"[^>]+data:image/png;base64,([^"]+)', text)
    return [np.asarray(Image.open(BytesIO(b64decode(data))).convert("RGBA")) for data in found]


# ── Spectrum ──


def test_the_spectrum_peaks_where_the_road_shakes(run: Trajectory) -> None:
    plot = spectrum_plot(run, "#000000", MARKS)
    assert plot.x[plot.values[:, 0].argmax()] == pytest.approx(15 / 3.6 / 7, abs=0.03)
    assert 0.5 < plot.values.max() < 1.5
    assert (plot.axis, plot.unit) == ("Frequency, Hz", "m/s²")
    assert plot.x[0] == 0
    assert 7.9 < plot.x[-1] <= 8


def test_the_axis_reaches_the_multiples_of_a_fast_excitation(run: Trajectory) -> None:
    plot = spectrum_plot(run, "#000000", (Mark("v/λ", 20.0, drives=True),))
    assert 59 < plot.x[-1] <= 60


def test_a_baseline_has_its_own_spectrum_at_the_same_frequencies(run: Trajectory) -> None:
    plot = spectrum_plot(run, "#000000", MARKS, replace(run, a=2 * run.a))
    assert [curve.kind for curve in plot.curves] == ["run", "baseline"]
    assert plot.values[:, 1] == pytest.approx(2 * plot.values[:, 0], abs=2e-3)
    assert np.isfinite(spectrum_plot(make_run(samples=3), "#000000", MARKS, run).values[:, 0]).all()


def test_power_density_and_the_drivers_seat(run: Trajectory) -> None:
    hull = spectrum_plot(run, "#000000", MARKS, run, density=True)
    felt = spectrum_plot(run, "#000000", MARKS, run, density=True, at_seat=True)
    assert (hull.unit, hull.curves[0].label, felt.curves[0].label) == ("m²/s³", "Centre of mass", "Driver's seat")
    assert felt.values.max() > 4 * hull.values.max()
    assert felt.values[:, 1] == pytest.approx(felt.values[:, 0])
    forward = replace(run, config=PAPER.replace({"vehicle.seat.x": 3}))
    both = spectrum_plot(run, "#000000", MARKS, forward, at_seat=True)  # the baseline's driver has a seat of his own
    assert both.values[:, 1].max() > 1.5 * both.values[:, 0].max()


def test_tabs_and_card_in_other_units(run: Trajectory) -> None:
    spectrum = spectrum_plot(run, "#000000", MARKS, density=True, units=US)
    metric = spectrum_plot(run, "#000000", MARKS, density=True)
    assert (spectrum.unit, metric.unit) == ("g²/Hz", "m²/s³")
    assert spectrum.values.max() == pytest.approx(metric.values.max() / 9.80665**2, rel=0.01)
    assert "Both, g<" in comfort_page(run, units=US)
    assert "VDV, m/s¹·⁷⁵<" in comfort_page(run, units=US)
    assert " g weighted" in comfort_headline(run, units=US)
    assert " lbf;" in trust_html(run, units=US)
    assert "Normal load of road wheels, lbf<" in load_map(run, units=US)
    assert "9.321 mph" in about_html(US)
    state = wheel_state(run, 0, 1.0)
    told = card(state, "#123456", load_unit(run.system, US), US)
    assert f"{state.normal_load / 4.4482216152605:.0f} lbf" in told
    assert " m/s" not in told
    assert " mm" not in told


def test_marks_are_named_and_the_highest_comes_first() -> None:
    assert [mark.name for mark in MARKS] == ["Bounce", "Pitch", "v/λ"]
    assert "Bounce 1.55 Hz" in marks_html(MARKS)
    assert named(None, None) == ()
    assert [mark.name for mark in named(0.6, Modes((), (), -1.0))] == ["v/λ"]


def test_all_modes_are_told_with_what_moves() -> None:
    table = modes_page(0.6, MODES)
    assert "<th>2 Bounce</th><td>1.55 Hz</td><td>55 %</td><td>follows, ×1.1</td>" in table
    assert "<td>hull up and down 87\N{NO-BREAK SPACE}%</td>" in table
    assert "<th>v/λ</th><td>0.60 Hz</td><td></td><td></td>" in table
    assert re.search(r"hop of I5 \d+\s%, hop of R5 \d+\s%", table)
    assert "Hop of R1 353" in table.split("<details>")[1]
    assert "<th>v/λ" not in modes_page(None, MODES)
    assert "no rest pose" in modes_page(0.6, None)


def test_modes_say_whether_the_road_excites_them() -> None:
    bounce = next(mode for mode in MODES.swinging if mode.name == "Bounce")
    assert response(0.0, 0.3) == 1.0
    assert response(1.0, 0.05) == pytest.approx((1 + 0.01) ** 0.5 / 0.1)
    assert excited(bounce, bounce.frequency).startswith("excited")
    assert excited(bounce, 10 * bounce.frequency).startswith("hardly")
    assert BY_ALL in modes_page(None, MODES)
    assert BY_NOTHING in modes_page(None, MODES, flat=True)


def test_a_logarithmic_axis_has_no_zero() -> None:
    run = simulate(PAPER)
    plot = spectrum_plot(run, "#000000", MARKS, logarithmic=True)
    assert plot.logarithmic
    assert plot.x[0] >= 0.1
    assert not spectrum_plot(run, "#000000", MARKS).x[0]


def test_each_mode_can_be_chosen_by_a_title_of_its_own() -> None:
    titles = mode_titles(MODES)
    assert titles[:2] == ("1 Pitch, 1.04 Hz", "2 Bounce, 1.55 Hz")
    assert len(set(titles)) == len(MODES.swinging) == 8
    alike = replace(MODES, swinging=(Mode("Pitch", -1 + 5j, (), MODES.swinging[0].shape),) * 2)
    assert len(set(mode_titles(alike))) == 2
    assert mode_titles(None) == ()


# ── Comfort ──


def cells_of(text: str, line: str) -> list[list[str]]:
    """The cells of a line in each table."""
    rows = re.findall(rf"<tr><td>{re.escape(line)}</td>(.*?)</tr>", text)
    return [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in rows]


def test_the_ride_in_a_line_and_in_a_table(run: Trajectory) -> None:
    felt, hull = (ride_comfort(run, point) for point in (seat(PAPER), CENTRE_OF_MASS))
    assert f"<b>fairly uncomfortable</b>, {figure_text(felt.total)} m/s² weighted" in comfort_headline(run)
    assert 'class="bad"' not in comfort_headline(run)
    text = comfort_page(run)
    assert all(figure.name in text for figure in COMFORT_FIGURES)
    assert cells_of(text, "Both, m/s²") == [[figure_text(felt.total)], [figure_text(hull.total)]]
    assert cells_of(text, "In words") == [["fairly uncomfortable"], ["a little uncomfortable"]]
    assert "Taken over the last 3 waves, from 5.0 s on, when the start has died away" in text
    assert "Taken over the whole run" in comfort_page(make_run(PAPER.replace({"road.type": "flat"})))


def test_the_ride_beside_a_baselines(run: Trajectory) -> None:
    faster = simulate(PAPER.replace({"drive.speed_kmh": 25}))
    assert re.search(r'class="bad">15\.\d W', comfort_headline(faster))
    text = comfort_page(faster, run)
    powers = [
        [figure_text(ride_comfort(of, point).absorbed_power) for of in (faster, run)]
        for point in (seat(PAPER), CENTRE_OF_MASS)
    ]
    assert [cells[:2] for cells in cells_of(text, "Absorbed power, W")] == powers
    assert cells_of(text, "VDV, m/s¹·⁷⁵")[0][2] == "–"  # the steady part is longer at another speed
    assert cells_of(comfort_page(run, run), "VDV, m/s¹·⁷⁵")[0][2] == "0 %"
    assert cells_of(comfort_page(run, make_run(samples=0)), "Both, m/s²")[0] == cells_of(text, "Both, m/s²")[0][1:2]


def test_what_one_must_know_of_the_ride_figures_stands_beside_them() -> None:
    half_round = load_config("half_round")
    short = simulate(half_round.replace({"simulation.duration": 2}))
    assert '<span class="bad">run too short</span>' in comfort_headline(short)
    assert "The run ends before the hull has settled behind the obstacle" in comfort_page(short)
    assert '<span class="bad">still settling</span>' in comfort_headline(short, driving=True)
    assert "The drive has just begun" in comfort_page(short, driving=True)
    assert "The run ends" not in comfort_page(short, driving=True)
    slow = simulate(half_round.replace({"simulation.output_rate": 20}))
    assert "uncomfortable" not in comfort_headline(slow)
    assert "20 a second" in comfort_headline(slow)
    assert "set the output rate to 200 1/s or more" in comfort_page(slow)
    assert "In words" not in comfort_page(slow)
    jolt = simulate(PAPER.replace({"road.type": "flat"}))
    jolt.a[1000, 0, 1] = 30.0
    assert '<span class="bad">crest factor' in comfort_headline(jolt)
    assert "Use MTVV" in comfort_page(jolt)


def test_a_run_without_samples_has_no_comfort() -> None:
    assert comfort_headline(make_run(samples=0)) == comfort_page(make_run(samples=0)) == ""
    assert "not uncomfortable" in comfort_headline(make_run(samples=1))


# ── Load map ──


def test_the_load_map_has_a_row_for_each_wheel_and_is_empty_in_the_air() -> None:
    run = make_run(samples=400)
    load = np.full_like(run.normal_load, 4e3)
    load[:, 0] = 8e3
    load[200:, 1] = 0
    road, imaginary = pictures(load_map(replace(run, normal_load=load)))
    assert road.shape == (6, 400, 4)
    assert imaginary.shape == (5, 400, 4)
    brightest, middle = load_colours(np.array([1.0, 0.5]))
    assert (road[0] == brightest).all()
    assert (road[1, :200] == middle).all()
    assert (road[1, 200:, 3] == 0).all()


def test_a_spike_of_one_sample_stands_in_the_load_map() -> None:
    run = make_run(samples=12_001)
    load = np.full_like(run.normal_load, 1e3)
    load[7777, 3] = 50e3
    for kind, most in (("far", 600), ("near", 4000)):
        road = pictures(load_map(replace(run, normal_load=load)), kind)[0]
        assert most / 2 < road.shape[1] <= most
        assert (road[3] == load_colours(np.array(1.0))).all(axis=1).sum() == 1


def test_a_baselines_maps_have_the_same_colours_and_end_where_it_ends() -> None:
    run, baseline = make_run(samples=200), make_run(PAPER.replace({"drive.speed_kmh": 30}), samples=100)
    road, other, *_ = pictures(load_map(run, baseline))
    assert other[:, :99, 3].all()
    assert not other[:, 101:, 3].any()
    assert road[0, 0, :3].sum() < other[0, 0, :3].sum()  # 15 kN of 30 kN


def test_the_load_map_of_any_vehicle() -> None:
    assert len(pictures(load_map(make_run(PAPER.replace({"vehicle.imaginary_wheels.enabled": False}))))) == 1
    run = make_run()
    flying = pictures(load_map(replace(run, normal_load=np.zeros_like(run.normal_load))))
    assert not any(picture[..., 3].any() for picture in flying)
    assert not pictures(load_map(make_run(samples=0)))
    assert len(pictures(load_map(make_run(samples=1)))) == 2


def test_load_colours_grow_lighter_all_the_way() -> None:
    colours = load_colours(np.linspace(0, 1, 50))[:, :3] @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(colours) > 0).all()
    assert tuple(load_colours(np.array(0.0))[:3]) == tuple(bytes.fromhex(RAMP[0][1:]))


# ── Trust ──


def test_a_good_run_passes_all_checks(run: Trajectory) -> None:
    checks = [*balances(run), drift(run)]
    assert [check.good for check in checks if check.good is not None] == [True, True, True]
    text = trust_html(run)
    assert str(run.statistics.evaluations) in text
    assert 'class="bad"' not in text


def test_what_breaks_the_laws_is_marked(run: Trajectory) -> None:
    q = run.q.copy()
    q[1000:, 0, 1] += 0.5  # the hull is lifted by nobody
    wrong = replace(run, q=q, normal_load=1.1 * run.normal_load, constraint_residual=run.constraint_residual + 1e-3)
    energy, forces, _ = balances(wrong)
    assert (energy.good, forces.good, drift(wrong).good) == (False, False, False)


def test_warnings_say_what_they_mean(run: Trajectory) -> None:
    q = run.q.copy()
    q[50, run.system.road_arms.start, 2] = 1.0
    text = trust_html(replace(run, q=q, tracked=None))
    assert "Road arm 1 turned by" in text
    assert "Give bump and rebound stops" in text


def test_a_stretch_of_a_drive_is_not_balanced_and_no_run_is_not_judged(run: Trajectory) -> None:
    assert "Energy" not in trust_html(run, driving=True)
    assert "Joints apart" in trust_html(run, driving=True)
    assert "&lt;b&gt;" in trust_html(make_run(samples=0, status="diverged at t = 0 s: <b>"))


def test_all_that_was_settled_is_listed() -> None:
    text = errata_html()
    assert text.count("<li>") == len(ERRATA)
    assert "<i>k</i>" not in text.split("paper_0583")[1][:20]


# ── About ──


def test_about_has_all_equations_and_every_parameter_once() -> None:
    text = about_html()
    assert all(law.title in text and str(formula_html(law.formulas[0])) in text for law in LAWS)
    assert text.count("<tr title=") == sum(parameter.group != NOTES for parameter in PARAMETERS)
    assert all(f"<h4>{group}</h4>" in text for group in GROUPS if group != NOTES)
    assert "75.53 kN/m" in text
    assert "_" not in re.sub(r"<[^>]*>", "", text)
