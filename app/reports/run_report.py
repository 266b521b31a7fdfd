"""The report of one run: a page for a colleague with everything needed to judge it and to repeat it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import version
from typing import NamedTuple

from matplotlib.figure import Figure

from app.format.differences import NONE, change_text, figure_text, row_texts
from app.format.file_names import file_name
from app.format.load_unit import comparison_rows, heading
from app.format.markup import Content, Html, element, formula_html, joined, words_html
from app.format.parameters import value_text
from app.plots.curves import Plot, load_plots
from app.plots.ride import ride_plots
from app.plots.spectrum import LEAST_SAMPLES, Mark, named, spectrum_plot
from app.reports.drawings import LIGHT_LOOK, WIDTH, Drawing, Look, plots_drawing
from app.reports.html_page import document, picture, wide_table
from app.reports.side_view import draw_side_view, highest_load
from app.tabs.comfort import COMFORT_FIGURES, PLACES, ComfortFigure
from app.tabs.modes import NOTE, moving
from app.tabs.trust import balances, drift, work
from model.analysis.comfort import Comfort, ride_comfort
from model.analysis.figures import WHEEL_FIGURES, Row, comparison, overall
from model.analysis.modes import Modes, vehicle_modes
from model.analysis.ride_warnings import warnings
from model.analysis.signals import WHOLE, window
from model.analysis.spectrum import excitation
from model.config.config import Config
from model.config.config_files import dump_config
from model.config.parameters import GROUPS, NOTES, PARAMETER, Value
from model.simulation.trajectory import Trajectory

MODEL = (
    "One side of the vehicle in plane motion; the track is replaced by imaginary wheels on sprung links between the "
    "road wheels, after Mahalingam and Padmanabhan. Masses and loads are those of this side."
)


class RideRow(NamedTuple):
    """One ride figure of the whole vehicle."""

    label: str
    value: str
    unit: str
    beside: str = ""  # the baseline's, and the change


def report_page(
    run: Trajectory,
    source: str,
    baseline: Trajectory | None = None,
    on_progress: Callable[[float], None] = lambda part: None,
) -> str:
    """The report as an HTML file. source: the name of the preset or file that was run. It needs one sample.

    baseline: a run that it is compared with; both need a sample. on_progress: called with the share that is done, 0…1,
    several times; what it raises ends the work.
    """
    config, modes = run.config, vehicle_modes(run.config)
    drawings = run_drawings(run, modes, baseline)
    pictures: list[Html] = []
    for drawing in drawings:
        on_progress(len(pictures) / (len(drawings) + 1))
        pictures.append(picture(drawing))
    on_progress(len(drawings) / (len(drawings) + 1))
    compared = None if baseline is None else baseline.config
    sections = [
        _early_end(run),
        element("p", config.description) if config.description else Html(),
        *_which_baseline(config, compared),
        picture(vehicle_drawing(run), _picture_words(run), ".png"),
        element("dl", *(_tile(row) for row in ride_rows(run, baseline))),
        element("h2", "Warnings"),
        _warnings(run),
        *_comparison(run, baseline),
        element("h2", "The run over time"),
        *pictures,
        element("h2", "Ride comfort"),
        _comfort(run),
        element("h2", "Natural frequencies and modes"),
        _modes(modes),
        element("h2", "Each wheel"),
        _wheels(run),
        element("h2", "Parameters"),
        *_parameters(config),
        element("h2", "Can the computation be trusted?"),
        _checks(run),
        element("h2", "Repeat it"),
        *_repeat(config, source, compared),
    ]
    return document(config.name, MODEL, sections)


def ride_rows(run: Trajectory, baseline: Trajectory | None = None) -> list[RideRow]:
    """The ride figures of the whole vehicle, as they stand at the head of the report."""
    return [
        RideRow(row.figure, figure_text(row.now), row.unit, _beside(row))
        for row in comparison(run, baseline)
        if not row.wheel
    ]


def _beside(row: Row) -> str:
    """ "baseline 1.35, +13 %"."""
    if row.baseline is None:
        return ""
    change = "" if row.change is None else f", {change_text(row.change)}"
    return f"baseline {row_texts(row)[1]}{change}"


def _which_baseline(config: Config, baseline: Config | None) -> Iterator[Html]:
    """What the run is compared with, and what differs between the two."""
    if baseline is None:
        return
    said = f"Beside the baseline, {baseline.name}: pale dashed curves, and a table with all changes."
    yield element("p", said)
    now, before = config.values(), baseline.values()
    keys = [key for key in PARAMETER if now.get(key) != before.get(key) and PARAMETER[key].group != NOTES]
    rows = [[*_parameter(config, key, now.get(key)), _value(baseline, key, before.get(key))] for key in keys]
    if rows:
        yield wide_table(("Parameter", "Symbol", "Here", "In the baseline"), rows, "facts")
    else:
        yield element("p", "Both have the same parameters.")


def _comparison(run: Trajectory, baseline: Trajectory | None) -> Iterator[Html]:
    """All figures of both runs: of a figure of each wheel the worst wheel, or all road wheels together."""
    if baseline is None:
        return
    told = comparison_rows(run, baseline)
    rows = [(row, row.figure) for row in told if not row.wheel]
    rows += [(of.row, f"{of.row.figure}, {of.row.wheel or 'road wheels together'}") for of in overall(told)]
    yield element("h2", "Beside the baseline")
    yield wide_table(
        ("Figure", "Unit", "Here", "Baseline", "Change"),
        [[name, row.unit, *row_texts(row), change_text(row.change)] for row, name in rows],
        "numbers",
    )


def vehicle_drawing(run: Trajectory) -> Drawing:
    """The vehicle on its road at the moment of the highest load."""

    def draw(figure: Figure, look: Look) -> None:
        axes = figure.add_axes((0, 0, 1, 1))
        draw_side_view(axes, run, look.palette(run.system), highest_load(run))

    return Drawing("The vehicle on its road", WIDTH, 3.9, draw)


def run_drawings(run: Trajectory, modes: Modes, baseline: Trajectory | None = None) -> list[Drawing]:
    """All plots of a run: ride, loads, spectrum; with the curves of a baseline."""
    found = named(excitation(run.config), modes)

    def plots(look: Look) -> list[Plot]:
        palette = look.palette(run.system)
        return [*ride_plots(run, palette, baseline), *load_plots(run, palette, baseline)]

    def drawing(number: int, title: str) -> Drawing:
        return plots_drawing(title, lambda look: [plots(look)[number]])

    drawings = [drawing(number, plot.title) for number, plot in enumerate(plots(LIGHT_LOOK))]
    return [*drawings, spectrum_drawing(run, found, baseline)] if len(run.t) >= LEAST_SAMPLES else drawings


def spectrum_drawing(run: Trajectory, found: tuple[Mark, ...], baseline: Trajectory | None = None) -> Drawing:
    """The spectrum of the hull's acceleration, with frequencies to know."""
    return plots_drawing(
        "Spectrum of the hull's vertical acceleration",
        lambda look: [spectrum_plot(run, look.palette(run.system).hull, found, baseline)],
        {mark.name: mark.frequency for mark in found},
    )


def _picture_words(run: Trajectory) -> str:
    return f"At t = {highest_load(run):.2f} s, when a wheel carries most. Arrows are normal loads."


def _tile(row: RideRow) -> Html:
    beside = [element("dd", row.beside, class_="beside")] if row.beside else []
    return element("div", element("dt", row.label), element("dd", row.value, " ", element("small", row.unit)), *beside)


def _early_end(run: Trajectory) -> Html:
    if run.complete:
        return Html()
    return element("p", f"This run is not complete: {run.status}. {run.advice}", class_="bad")


def _warnings(run: Trajectory) -> Html:
    found = warnings(run)
    if not found:
        words = "Nothing: it is exact, and arms, penetration and wavelength are within what the model was made for."
        return element("p", words, class_="good")
    items = (element("li", element("b", warning.what), ". ", warning.meaning) for warning in found)
    return element("ul", *items, class_="warnings")


def _wheels(run: Trajectory) -> Html:
    told = comparison_rows(run, None)
    rows = {(row.wheel, row.figure): row_texts(row)[0] for row in told if row.wheel}
    heads = ["Wheel", *(heading(figure.label, told) for figure in WHEEL_FIGURES)]
    wheels = dict.fromkeys(wheel for wheel, _ in rows)
    return wide_table(
        heads,
        [[wheel, *(rows.get((wheel, figure.label), NONE) for figure in WHEEL_FIGURES)] for wheel in wheels],
        "numbers",
    )


def _comfort(run: Trajectory) -> Html:
    taken = window(run)
    felt = [(place, ride_comfort(run, point(run.config), taken)) for place, point in PLACES]
    rows = [
        [f"{figure.name}, {figure.unit}".strip(", "), *(_number(figure, of) for _, of in felt), figure.meaning]
        for figure in COMFORT_FIGURES
    ]
    reactions = (NONE if of is None else of.reaction for _, of in felt)
    words = ["In words", *reactions, "of ISO 2631-1, the harsher one where two apply"]
    note = element("p", f"Taken {taken.why}, like all means on this page; {WHOLE}.")
    return joined((wide_table(["", *(place for place, _ in felt), ""], [*rows, words], "facts"), note))


def _number(figure: ComfortFigure, of: Comfort | None) -> str:
    return NONE if of is None else figure_text(figure.value(of))


def _modes(modes: Modes) -> Html:
    rows = [
        [mode.name, f"{mode.frequency:.2f} Hz", f"{100 * mode.damping_ratio:.0f} %", moving(mode)]
        for mode in modes.swinging
    ]
    heads = ("Mode", "Frequency", "Damping", "What moves, by its part in the energy")
    return joined((wide_table(heads, rows, "facts"), element("p", NOTE)))


def _parameters(config: Config) -> Iterator[Html]:
    """What differs from the paper's vehicle first, then everything by groups."""
    values, paper = config.values(), Config().values()
    shown = {key: value for key, value in values.items() if PARAMETER[key].group != NOTES}
    changed = [key for key, value in shown.items() if key not in paper or paper[key] != value]
    yield element("h3", "Different from the paper's vehicle")
    if changed:
        heads = ("Parameter", "Symbol", "Here", "In the paper's vehicle", "What it is")
        yield wide_table(
            heads, [[*_parameter(config, key, shown[key]), _before(paper, key), _words(key)] for key in changed]
        )
    else:
        yield element("p", "Nothing: this is the paper's vehicle as Trackride reads it.")
    for group in GROUPS:
        rows = [
            [*_parameter(config, key, value), PARAMETER[key].source, _words(key)]
            for key, value in shown.items()
            if PARAMETER[key].group == group and key not in changed
        ]
        if rows:
            yield element("h3", group)
            yield wide_table(("Parameter", "Symbol", "Value", "From", "What it is"), rows, "parameters")


def _parameter(config: Config, key: str, value: Value) -> list[Content]:
    parameter = config.parameter(key)
    return [parameter.label, formula_html(parameter.symbol), _value(config, key, value)]


def _value(config: Config, key: str, value: Value) -> str:
    return NONE if value is None else value_text(config.parameter(key), value)


def _before(paper: Mapping[str, Value], key: str) -> str:
    """The paper's value of a changed parameter, and where that is from."""
    if key not in paper:
        return NONE
    return f"{value_text(PARAMETER[key], paper[key])} ({PARAMETER[key].source})"


def _words(key: str) -> Html:
    return element("small", words_html(PARAMETER[key].description))


def _checks(run: Trajectory) -> Html:
    checks = [*balances(run), drift(run)] if len(run.t) > 1 else [drift(run)]
    rows: list[list[Content]] = [
        [check.name, joined((check.value, _judgement(check.good))), check.meaning] for check in (*checks, *work(run))
    ]
    return wide_table((), rows, "facts")


def _judgement(good: bool | None) -> Html:
    if good is None:
        return Html()
    return element("span", " ✓", class_="good") if good else element("span", " !", class_="bad")


def _repeat(config: Config, source: str, baseline: Config | None) -> Iterator[Html]:
    file = file_name(config, config.name, {}, "", ".yaml")
    yield element(
        "p",
        f"This report was made from “{source}”. The text below is the whole configuration, defaults and changes "
        f"included. Save it as {file} and give that file to Trackride {version('trackride')}:",
    )
    commands = (f"trackride explore {file}", f"trackride report {file} --out report.html")
    yield element("pre", "\n".join(commands))
    yield element("details", element("summary", "The configuration as YAML"), element("pre", dump_config(config)))
    if baseline is not None:
        shown = element("summary", "The baseline as YAML"), element("pre", dump_config(baseline))
        yield element("details", *shown)
