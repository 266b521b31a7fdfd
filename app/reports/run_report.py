"""The report of one run: a page for a colleague with everything needed to judge it and to repeat it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib.metadata import version
from typing import NamedTuple

from matplotlib.figure import Figure

from app.format.differences import NONE, figure_text, row_texts
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
from model.analysis.figures import WHEEL_FIGURES, comparison
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


def report_page(run: Trajectory, source: str) -> str:
    """The report as an HTML file. source: the name of the preset or file that was run. It needs one sample."""
    config, modes = run.config, vehicle_modes(run.config)
    sections = [
        _early_end(run),
        element("p", config.description) if config.description else Html(),
        picture(vehicle_drawing(run), _picture_words(run), ".png"),
        element("dl", *(_tile(row) for row in ride_rows(run))),
        element("h2", "Warnings"),
        _warnings(run),
        element("h2", "The run over time"),
        *(picture(drawing) for drawing in run_drawings(run, modes)),
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
        *_repeat(config, source),
    ]
    return document(config.name, MODEL, sections)


def ride_rows(run: Trajectory) -> list[RideRow]:
    """The ride figures of the whole vehicle, as they stand at the head of the report."""
    return [RideRow(row.figure, figure_text(row.now), row.unit) for row in comparison(run, None) if not row.wheel]


def vehicle_drawing(run: Trajectory) -> Drawing:
    """The vehicle on its road at the moment of the highest load."""

    def draw(figure: Figure, look: Look) -> None:
        axes = figure.add_axes((0, 0, 1, 1))
        draw_side_view(axes, run, look.palette(run.system), highest_load(run))

    return Drawing("The vehicle on its road", WIDTH, 3.9, draw)


def run_drawings(run: Trajectory, modes: Modes) -> list[Drawing]:
    """All plots of a run: ride, loads, spectrum."""
    found = named(excitation(run.config), modes)

    def plots(look: Look) -> list[Plot]:
        palette = look.palette(run.system)
        return [*ride_plots(run, palette), *load_plots(run, palette)]

    def drawing(number: int, title: str) -> Drawing:
        return plots_drawing(title, lambda look: [plots(look)[number]])

    drawings = [drawing(number, plot.title) for number, plot in enumerate(plots(LIGHT_LOOK))]
    return [*drawings, spectrum_drawing(run, found)] if len(run.t) >= LEAST_SAMPLES else drawings


def spectrum_drawing(run: Trajectory, found: tuple[Mark, ...]) -> Drawing:
    """The spectrum of the hull's acceleration, with frequencies to know."""
    return plots_drawing(
        "Spectrum of the hull's vertical acceleration",
        lambda look: [spectrum_plot(run, look.palette(run.system).hull, found)],
        {mark.name: mark.frequency for mark in found},
    )


def _picture_words(run: Trajectory) -> str:
    return f"At t = {highest_load(run):.2f} s, when a wheel carries most. Arrows are normal loads."


def _tile(row: RideRow) -> Html:
    return element("div", element("dt", row.label), element("dd", row.value, " ", element("small", row.unit)))


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
    return [parameter.label, formula_html(parameter.symbol), value_text(parameter, value)]


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


def _repeat(config: Config, source: str) -> Iterator[Html]:
    file = file_name(config, config.name, {}, "", ".yaml")
    yield element(
        "p",
        f"This report was made from “{source}”. The text below is the whole configuration, defaults and changes "
        f"included. Save it as {file} and give that file to Trackride {version('trackride')}:",
    )
    commands = (f"trackride explore {file}", f"trackride report {file} --out report.html")
    yield element("pre", "\n".join(commands))
    yield element("details", element("summary", "The configuration as YAML"), element("pre", dump_config(config)))
