"""How the panels share the page. The page tells its size (page.js); the sizes follow from it."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Literal

Plots = Literal["beside", "under", "large"]  # where they stand: beside the view, under it, or over it

USUAL = 1600, 900  # px, width and height of a page on which type has its usual size
GROWTH = 0.45  # how much of what a page is larger than that goes into its type
LARGEST = 1.6  # times as large as usual: type on the largest page
LEFT, NARROW_LEFT = 345, 316  # px of usual type, width of the control panel, and where the plots are under the view
NARROW_PAGE = 1200  # px of usual type: on a page less wide the plots go under the view
VIEW_SHARE = 0.56  # of the height that is the view's then
RIGHT, WIDEST = 470, 900  # px of usual type, width of the plots at least, and at most
PLOTS_SHARE = 0.32  # of the page's width
DOCKED_UNDER = 96  # px that viser is told for plots that page.css puts under the view: the least it takes
SEAMS = 8  # px that viser puts between docked panels and the view
PLAYER, SHORT_PLAYER = 560, 260  # px of usual type, width of the player at most; px, at least
MARGINS = 24  # px beside it
FOOT = 200  # px of usual type below large plots: the player is there
COLUMN = 340  # px of usual type that a chart needs to stand beside another
# All from here on in px of usual type
MODES = 560  # beside the spectrum: its boxes and the table of a paper's vehicle's modes
PLOTS_HEAD = 92  # above the plots in their panel: its tabs, the plots' tools
AXIS_NAME = 16  # that the name of the axis takes below the last plot
LOWEST, HIGHEST = 100, 700  # of a chart
CARD = 46  # that one plot takes beyond its chart: title, legend, margins


@dataclass(frozen=True)
class PageLayout:
    """Sizes, px."""

    width: int  # of the page
    height: int
    scale: float  # times its usual size: type, and what holds it
    left: int  # width of the control panel
    docked: int  # width of the plots' panel where it stands beside the view
    plots: Plots
    right: int  # width of the plots' panel as it stands
    plots_height: int  # its height
    player_x: int  # left edge of the player, from the view's
    player_width: int
    below: int  # from the lower edge of the view to the page's

    @property
    def columns(self) -> int:
        """Charts side by side."""
        return max(int(self.right / (COLUMN * self.scale)), 1) if self.plots != "beside" else 1

    def chart_height(self, plots: int, taken: float = 0.0) -> int:
        """Height of each of so many charts that together fill their panel; taken: px of usual type for other things."""
        rows = ceil(max(plots, 1) / self.columns)
        room = self.plots_height / self.scale - PLOTS_HEAD - AXIS_NAME - taken
        return int(self.scale * min(max(room / rows - CARD, LOWEST), HIGHEST))

    def spectrum_height(self) -> int:
        """Height of the chart of the spectrum: half of its panel, or more if boxes and table of modes leave more."""
        half = (self.plots_height / self.scale - PLOTS_HEAD - AXIS_NAME) / 2 - CARD
        whole = self.plots_height / self.scale - PLOTS_HEAD - AXIS_NAME - MODES - CARD
        return int(self.scale * min(max(half, whole, LOWEST), HIGHEST))


def page_layout(width: int, height: int, view: int | None = None, *, large: bool = False) -> PageLayout:
    """Sizes for a page, px.

    view: width of the view, where the user has moved a seam; large: the plots stand over the view.
    """
    larger = min(width / USUAL[0], height / USUAL[1]) - 1
    scale = round(min(max(1 + GROWTH * larger, 1.0), LARGEST), 2)
    under = width < NARROW_PAGE * scale
    left = int(scale * (NARROW_LEFT if under else LEFT))
    docked = int(min(max(RIGHT * scale, PLOTS_SHARE * width), WIDEST * scale))
    below = int((1 - VIEW_SHARE) * height) if under and not large else 0
    if below:
        docked = DOCKED_UNDER
    view = view or width - left - SEAMS - (0 if below else docked)
    player = int(max(min(view - MARGINS, PLAYER * scale), SHORT_PLAYER))
    right, plots_height = width - left, height - int(FOOT * scale) if large else below
    plots: Plots = "large" if large else "under"
    if not (large or under):
        plots, right, plots_height = "beside", docked, height
    x = max(int((view - player) / 2), 0)
    return PageLayout(width, height, scale, left, docked, plots, right, plots_height, x, player, below)
