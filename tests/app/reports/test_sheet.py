"""The stamped figure: what stands on the sheet, and that all of it fits."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib.metadata import version
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D
from matplotlib.text import Text
from PIL import Image

from app.format.colours import wheel_palette
from app.format.differences import figure_text
from app.reports.sheet import BOTTOM, compose, stamped_figure
from app.reports.sheet_page import DPI, HEIGHT, MARGIN, WIDTH, Sheet
from app.view3d.meshes.hull import PAINT
from model import load_config, simulate
from model.analysis.ride import Summary
from model.analysis.signals import window
from model.config.config import Config
from model.simulation.trajectory import Trajectory

PAPER = load_config("paper")
SOFT = PAPER.replace({"vehicle.road_suspension.damping": 2366, "name": "Half the damping"})


@pytest.fixture(scope="module")
def paper() -> Trajectory:
    return simulate(PAPER)


@pytest.fixture(scope="module")
def soft() -> Trajectory:
    return simulate(SOFT)


@pytest.fixture(scope="module")
def alone(paper) -> Sheet:
    return compose(paper, None, None, "Title")


@pytest.fixture(scope="module")
def compared(paper, soft) -> Sheet:
    return compose(soft, paper, None, "Title")


@pytest.fixture(scope="module")
def pictured(paper) -> Sheet:
    return compose(paper, None, picture(), "Title")


def short_run(changes: dict) -> Trajectory:
    return simulate(PAPER.replace({"simulation.duration": 1.5, "simulation.output_rate": 100, **changes}))


def placed(sheet: Sheet) -> list[Text]:
    """All texts that are written on the sheet, axes' own labels aside."""
    return [text for text in sheet.figure.texts if text.get_text()]


def words(sheet: Sheet) -> list[str]:
    return [text.get_text() for text in placed(sheet)]


def plots(sheet: Sheet) -> dict[str, Axes]:
    """The axes by their titles."""
    return {axes.get_title(loc="left"): axes for axes in sheet.figure.axes if axes.get_title(loc="left")}


def curves(axes: Axes) -> list[Line2D]:
    """Without the dots at their peaks."""
    return [line for line in axes.get_lines() if line.get_marker() != "o"]


def picture(colour: tuple[int, int, int] = (250, 20, 200)) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (320, 180), colour).save(file, "PNG")
    return file.getvalue()


def test_a_png_is_an_a4_page(paper, soft):
    data = stamped_figure(soft, paper, None, "Paper vehicle, road damping 4.73 → 2.37 kN s/m", ".png")
    image = Image.open(io.BytesIO(data))
    assert image.format == "PNG"
    assert image.size == (int(WIDTH * DPI), int(HEIGHT * DPI))
    assert image.info["Title"].startswith("Paper vehicle")
    assert image.info["Software"] == f"Trackride {version('trackride')}"
    pixels = np.asarray(image.convert("RGB")).astype(int)
    edge = int(0.5 * MARGIN * DPI)
    for strip in (pixels[:edge], pixels[:, :edge], pixels[:, -edge:]):
        assert (strip == 255).all()
    assert 0.1 < (pixels.min(axis=2) < 250).mean() < 0.6


def test_an_svg_is_whole_and_says_what_was_changed(paper, soft):
    data = stamped_figure(soft, paper, None, "A $title$ with <signs> & all", ".svg")
    ElementTree.fromstring(data)
    text = data.decode()
    assert len(data) < 2e6
    assert f"Trackride {version('trackride')}" in text
    for part in ("2.366 kN s/m", "was 4.732 kN s/m", "Half the damping", "Normal load of road wheels, kN", "5125 kg"):
        assert part in text, part


def test_an_svg_holds_text_as_text_and_names_other_fonts_for_those_who_lack_ours(paper):
    root = ElementTree.fromstring(stamped_figure(paper, None, None, "Title", ".svg"))
    texts = list(root.iter("{http://www.w3.org/2000/svg}text"))
    assert {"Title", "5125 kg", "Normal load of road wheels, kN"} <= {text.text for text in texts}
    styles = {style for text in texts for part in text.iter() if (style := part.get("style")) and "font" in style}
    assert all("sans-serif" in style for style in styles if "DejaVu Sans'" in style)
    assert len(styles) > 5


def test_another_suffix_is_refused(paper):
    with pytest.raises(ValueError, match=r"only as \.png or \.svg"):
        stamped_figure(paper, None, None, "x", ".pdf")


def test_what_was_changed_comes_first_and_everything_is_there(compared):
    texts = placed(compared)
    height = {text.get_text(): text.get_position()[1] for text in texts}
    assert height["2.366 kN s/m"] == height["was 4.732 kN s/m"]
    others = [value for label, value in height.items() if label in ("5125 kg", "75.53 kN/m", "15 km/h", "60 MN/m²")]
    assert len(others) == 4
    assert all(value < height["2.366 kN s/m"] for value in others)
    assert "4.732 kN s/m" not in words(compared)
    assert sum(label.startswith("Suspension damping") for label in words(compared)) == 1


def test_without_a_baseline_changes_are_against_the_papers_vehicle(soft, alone):
    assert "as in the paper's vehicle" in words(alone)
    sheet = compose(soft, None, None, "Title")
    assert "was 4.732 kN s/m" in words(sheet)
    assert "baseline" not in words(sheet)
    flat = compose(short_run({"road.type": "flat"}), None, None, "Title")
    assert "was sine" in words(flat)
    round_one = words(compose(short_run({"road.type": "half_round"}), None, None, "Title"))
    assert "100 mm" in round_one
    assert not any("None" in word for word in round_one)


def test_the_ride_figures_stand_beside_the_baselines(paper, soft, compared):
    for run in (paper, soft):
        assert figure_text(Summary(run).acceleration_rms) in words(compared)
        felt = Summary(run).seat
        assert felt is not None
        assert {figure_text(value) for value in (felt.shock, felt.dose, felt.transient)} <= set(words(compared))
        assert figure_text(run.normal_load[:, 0].max() / 1e3) in words(compared)
    change = 100 * (soft.normal_load[:, 5].max() / paper.normal_load[:, 5].max() - 1)
    assert f"{change:+.1f}".replace("-", "−") in words(compared)
    assert f"means of {window(soft).start:.2f} to {window(soft).end:.2f} s" in words(compared)


def test_the_plots_show_both_runs_in_the_wheels_colours(paper, soft):
    found = plots(compose(soft, paper, picture(), "Title"))
    assert list(found) == [
        "Vertical acceleration of the hull, m/s²",
        "Normal load of imaginary wheels, kN",
        "Normal load of road wheels, kN",
    ]
    lines = curves(found["Normal load of road wheels, kN"])
    assert len(lines) == 12
    for k, line in enumerate(lines):
        run = paper if k < 6 else soft
        np.testing.assert_allclose(line.get_ydata(), run.normal_load[:, k % 6] / 1e3)
        assert to_hex(line.get_color()) == wheel_palette(6, 5).road[k % 6]
        assert line.is_dashed() == (k < 6)
        assert (line.get_alpha() or 1.0) == (0.5 if k < 6 else 1.0)
    acceleration = found["Vertical acceleration of the hull, m/s²"].get_lines()
    np.testing.assert_allclose(acceleration[1].get_ydata(), soft.a[:, 0, 1])


def test_a_picture_that_is_given_is_shown_and_its_time_marked(paper, pictured):
    sheet = compose(paper, None, picture((250, 20, 200)), "Title", time=2.5)
    FigureCanvasAgg(sheet.figure).draw()
    pixels = np.asarray(sheet.figure.canvas.buffer_rgba())[..., :3].astype(int)
    assert (np.abs(pixels - (250, 20, 200)).max(axis=2) < 8).sum() > 0.8 * (2.6 * DPI) ** 2 * 16 / 9
    for axes in plots(sheet).values():
        assert list(axes.get_lines()[-1].get_xdata()) == [2.5, 2.5]
    assert len(curves(plots(pictured)["Normal load of road wheels, kN"])) == 6


def test_peaks_are_dots_and_the_largest_has_its_number(paper, pictured):
    axes = plots(pictured)["Normal load of road wheels, kN"]
    dots = [line for line in axes.get_lines() if line.get_marker() == "o"]
    assert [float(dot.get_ydata()[0]) for dot in dots] == pytest.approx(paper.peaks.load[:6] / 1e3, abs=0.01)
    assert [float(dot.get_xdata()[0]) for dot in dots] == pytest.approx(paper.peaks.load_time[:6])
    assert [to_hex(dot.get_color()) for dot in dots] == list(wheel_palette(6, 5).road)
    assert f"{paper.peaks.load[:6].max() / 1e3:.1f}" in [text.get_text() for text in axes.texts]


def test_without_a_picture_the_vehicle_is_drawn_with_the_loads_it_has(paper):
    moment = float(paper.t[(paper.normal_load <= 0).sum(axis=1).argmax()])
    loaded = int((paper.normal_load[int(moment * 200)] > 0).sum())
    sheet = compose(paper, None, None, "Title", time=moment)
    view = sheet.figure.axes[0]
    arrows = [text for text in view.texts if hasattr(text, "arrow_patch")]
    assert 0 < loaded < 11
    assert len(arrows) == loaded
    assert {text.get_text() for text in view.texts} >= {"R1", "R6", "I1", "I5"}
    FigureCanvasAgg(sheet.figure).draw()
    pixels = np.asarray(sheet.figure.canvas.buffer_rgba())[..., :3].astype(float)
    box = view.get_window_extent()
    seen = pixels[int(-box.y1) : int(-box.y0), int(box.x0) : int(box.x1)]
    paint = np.array(PAINT[:3]) / np.linalg.norm(PAINT[:3])
    brightness = np.linalg.norm(seen, axis=2)
    assert ((seen @ paint > 0.99 * brightness) & (brightness < 300) & (brightness > 80)).mean() > 0.1


CASES: dict[str, tuple[dict, dict | None]] = {
    "the paper's": ({}, None),
    "no imaginary wheels": ({"vehicle.imaginary_wheels.enabled": False}, {}),
    "two wheels": ({"vehicle.road_wheels.count": 2, "vehicle.road_wheels.spacing": 3.0}, {}),
    "twenty wheels, a value for each, beside six": (
        {
            "vehicle.road_wheels.count": 20,
            "vehicle.road_suspension.stiffness": tuple(60000.0 + 1234.5 * k for k in range(20)),
            "name": "A name of many words " * 4,
        },
        {},
    ),
    "everything changed": (
        {
            key: value * 1.01
            for key, value in Config().values().items()
            if isinstance(value, float) and not key.startswith("simulation")
        },
        {},
    ),
    "formulas in names": ({"name": r"100 $ and \frac{1}{0} $x^"}, {"name": "$$"}),
}


@pytest.mark.parametrize("case", CASES)
def test_everything_fits_on_the_page(case):
    changes, baseline = CASES[case]
    sheet = compose(short_run(changes), None if baseline is None else short_run(baseline), None, f"{case} $" * 20)
    renderer = FigureCanvasAgg(sheet.figure).get_renderer()
    left, right, tables = MARGIN - 0.03, WIDTH - MARGIN + 0.03, WIDTH / 2
    lowest = HEIGHT
    for text in placed(sheet):
        box = text.get_window_extent(renderer)
        assert left * DPI <= box.x0, text
        assert box.x1 <= right * DPI, text
        assert 0.2 * DPI <= box.y0, text
        assert box.y1 <= (HEIGHT - MARGIN) * DPI, text
        if box.x0 > tables * DPI and text.get_position()[1] * HEIGHT > 0.3:
            lowest = min(lowest, text.get_position()[1] * HEIGHT)
    assert lowest > BOTTOM - 0.02


@pytest.mark.parametrize("baseline", [False, True])
def test_of_many_wheels_those_that_matter_are_told_in_type_that_can_be_read(alone, baseline):
    many = short_run({"vehicle.road_wheels.count": 20})
    sheet = compose(
        many, short_run({"vehicle.road_wheels.count": 20, "road.amplitude": 0.05}) if baseline else None, None, ""
    )
    assert min(text.get_fontsize() for text in placed(sheet)) >= 6.0
    told = {word for word in words(sheet) if word[0] in "RI" and word[1:].isdigit()}
    most_loaded = many.normal_load.max(axis=0)
    assert told >= {"R1", "R20", "I1", "I19", f"R{most_loaded[:20].argmax() + 1}", f"I{most_loaded[20:].argmax() + 1}"}
    assert len(told) <= 11
    assert any(word.startswith("Of 39 wheels") for word in words(sheet))
    assert not any(word.startswith("Of 11") for word in words(alone))


@pytest.mark.parametrize("preset", [None, "m113", "robot"])
def test_texts_of_a_row_do_not_run_into_each_other(compared, preset):
    """A preset's parameters, all of them unchanged against itself, stand in columns."""
    sheet = compared
    if preset is not None:
        run = simulate(load_config(preset).replace({"simulation.duration": 1.5}))
        sheet = compose(run, run, None, "Title")
    renderer = FigureCanvasAgg(sheet.figure).get_renderer()
    rows: dict[float, list] = {}
    for text in placed(sheet):
        rows.setdefault(round(text.get_position()[1], 5), []).append(text.get_window_extent(renderer))
    for boxes in rows.values():
        boxes.sort(key=lambda box: box.x0)
        assert all(one.x1 < other.x0 for one, other in pairwise(boxes))


def test_a_run_that_ended_early_says_so(paper, alone):
    broken = replace(paper, status="diverged at t = 1.5 s: the step became too small")
    assert any(
        "Mind: the run is not complete: diverged at t = 1.5 s" in word
        for word in words(compose(broken, None, None, ""))
    )
    assert not any("Mind" in word for word in words(alone))


def test_several_threads_may_make_figures_at_once(paper):
    with ThreadPoolExecutor(2) as threads:
        made = list(threads.map(lambda title: stamped_figure(paper, None, None, title, ".svg"), ("One", "Two")))
    for data, title in zip(made, ("One", "Two"), strict=True):
        ElementTree.fromstring(data)
        assert f">{title}</text>" in data.decode()
