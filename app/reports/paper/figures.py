"""The figures of the paper, drawn from our runs, and the curves of its claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from app.plots.curves import load_plots
from app.plots.ride import ride_plots
from app.plots.spectrum import spectrum_plot
from app.reports.drawings import HEADROOM, SMALL, WIDTH, Drawing, Look, mark, panels, plain_axes, plots_drawing
from app.reports.paper.words import HARDLY
from model.paper.study import Figures, PaperStudy

Measure = Callable[[Figures], float]
TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10)  # of the imaginary stiffness


def acceleration(study: PaperStudy) -> Drawing:
    """Fig. 5 (b): the hull's vertical acceleration over time."""
    run = study.run
    title = "Vertical acceleration of the hull over time"
    return plots_drawing(title, lambda look: ride_plots(run, look.palette(run.system))[:1])


def spectrum(study: PaperStudy) -> Drawing:
    """Fig. 6: its spectrum, with its peak and the frequency at which waves are met."""
    run, paper = study.run, study.paper.figures
    return plots_drawing(
        "Spectrum of the hull's vertical acceleration",
        lambda look: [spectrum_plot(run, look.palette(run.system).hull, ())],
        {f"v/λ = {paper.excitation:.3f} Hz; the peak is at {paper.peak_frequency:.2f} Hz": paper.excitation},
    )


def loads(study: PaperStudy) -> Drawing:
    """Fig. 7: normal loads of road wheels, and of imaginary wheels, over time."""
    run = study.run
    title = "Normal loads of road wheels and imaginary wheels over time"
    return plots_drawing(title, lambda look: load_plots(run, look.palette(run.system))[:2])


def claims(study: PaperStudy) -> Drawing:
    """Share of the load and rms acceleration over imaginary stiffness, for both kinds of preload."""

    def draw(figure: Figure, look: Look) -> None:
        shown: dict[str, Measure] = {
            "Mean load carried by imaginary wheels, %": lambda f: 100 * f.share,
            "Vertical acceleration of the hull, rms, m/s²": lambda f: f.acceleration_rms,
        }
        panel = panels(figure, 1, 2)
        for axes, (title, of) in zip(panel, shown.items(), strict=True):
            plain_axes(axes, look, title, "Imaginary stiffness, times Table 1's")
            axes.set_xscale("log")
            axes.set_xticks(TICKS)
            axes.xaxis.set_minor_locator(NullLocator())
            axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
            for name, sweep, colour in (
                ("same preload angle", study.stiffness, look.accents[0]),
                ("same preload force", study.stiffness_same_force, look.accents[1]),
            ):
                _line(axes, sweep, of, colour, name)
            axes.set_ylim(0)
            mark(axes, "Table 1", 1.0, look, row=6)
            _legend(axes, look)
        reference = study.paper.figures.acceleration_rms
        panel[1].axhspan((1 - HARDLY) * reference, (1 + HARDLY) * reference, color=look.grey, alpha=0.3, lw=0)

    return Drawing("Two claims over the stiffness of the imaginary springs", WIDTH, 3.3, draw)


def harmonics(study: PaperStudy) -> Drawing:
    """Amplitudes at multiples of v/λ, as parts of the first, over the road's amplitude and over speed."""

    def draw(figure: Figure, look: Look) -> None:
        left, right = panels(figure, 1, 2)
        plain_axes(left, look, "Harmonics, % of the fundamental", "Amplitude of the road, mm")
        plain_axes(right, look, "Harmonics, % of the fundamental", "Speed, km/h")
        for axes, sweep, factor in ((left, study.amplitudes, 1e3), (right, study.speeds, 1.0)):
            for number, colour in zip((2, 3), look.accents, strict=True):
                _line(axes, sweep, _harmonic(number), colour, f"{number} v/λ", factor)
            axes.set_ylim(0, axes.get_ylim()[1] * (1 + HEADROOM))
            _legend(axes, look)
        mark(left, "paper", 100.0, look)
        mark(right, "paper", 15.0, look)

    return Drawing("Harmonics over the road's amplitude and over speed", WIDTH, 3.3, draw)


PAPER_FIGURES: dict[str, tuple[Callable[[PaperStudy], Drawing], str]] = {
    "fig5_acceleration": (
        acceleration,
        "As the paper's Fig. 5 (b). The vehicle starts at full speed, and the waves grow to their height over the "
        "first of them.",
    ),
    "fig6_spectrum": (
        spectrum,
        "As the paper's Fig. 6: amplitudes over the steady part of the run above (a Hann window widens the peaks).",
    ),
    "fig7_loads": (loads, "As the paper's Fig. 7. R1 and I1 are at the front; dotted: mean load at rest."),
    "claims": (
        claims,
        "The paper's two observations, for both ways to read the preload, which it does not give. Grey: no more than "
        f"{100 * HARDLY:g} % from the acceleration at Table 1's stiffness.",
    ),
    "harmonics": (
        harmonics,
        "How strong the second and the third harmonic are beside the fundamental, with the speed kept by our "
        "controller.",
    ),
}


def _harmonic(number: int) -> Measure:
    """Its amplitude in % of the fundamental's."""
    return lambda figures: 100 * figures.harmonics[number - 1] / figures.harmonics[0]


def _line(axes: Axes, sweep: Mapping[float, Figures], of: Measure, colour: str, name: str, factor: float = 1.0) -> None:
    values = np.array([[factor * value, of(figures)] for value, figures in sweep.items()])
    axes.plot(values[:, 0], values[:, 1], color=colour, lw=1.5, marker="o", ms=3.5, label=name)


def _legend(axes: Axes, look: Look) -> None:
    axes.legend(fontsize=SMALL, frameon=False, labelcolor=look.ink, loc="upper left")
