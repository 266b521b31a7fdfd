"""How the panels share the page. viser does not tell the size of the page: it follows from that of the 3-D view."""

from __future__ import annotations

from dataclasses import dataclass

LEFT = 345  # px, width of the control panel
RIGHT = 470  # px, width of the plots at least…
NARROW = 320  # … and where the page has no room for that beside the player
WIDEST = 760  # px, width of the plots at most
PLOTS_SHARE = 0.3  # of the page's width
SEAMS = 8  # px that viser puts between docked panels and the view
PLAYER, SHORT_PLAYER = 560, 300  # px, width of the player at most, and at least
MARGINS = 24  # px beside it
MODES = 485  # px beside the spectrum: three boxes and the table of a paper's vehicle's modes
PLOTS_HEAD = 66  # px above the plots in their panel
AXIS_NAME = 16  # px that the name of the axis takes below the last plot
LOWEST, HIGHEST = 110, 700  # px, of a chart
CARD = 46  # px that one plot takes beyond its chart: title, legend, margins
SCALES = (0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 3.5, 4.0)  # screen pixels for each px


@dataclass(frozen=True)
class PageLayout:
    """Sizes, px."""

    right: int  # width of the plots' panel
    player_x: int  # left edge of the player, from the view's
    player_width: int
    page_height: int


class Screen:
    """The page behind a view that is at first as wide as the page, and narrower once both panels are docked."""

    def __init__(self, width: int, height: int) -> None:
        """Size of the view before docking, screen pixels."""
        self._full_width = width
        self._seen = (width, height)
        self._scale: float | None = None  # screen pixels for each px, once it is known
        self._right = RIGHT

    def first(self) -> PageLayout:
        """Sizes to begin with, as if a screen pixel were a px."""
        width, height = self._seen
        return _layout(width - LEFT - self._right - SEAMS, height, self._right)

    def update(self, width: int, height: int) -> PageLayout | None:
        """New sizes when the view's size, in screen pixels, has changed with the page or the panels; else None."""
        before, self._seen = self._seen, (width, height)
        if self._seen == before or not width or not height:
            return None
        if self._scale is None:
            measured = (self._full_width - width) / (LEFT + RIGHT + SEAMS)
            nearest = min(SCALES, key=lambda scale: abs(scale - measured))
            if abs(nearest - measured) > 0.02 * nearest:
                return None  # not yet docked
            self._scale = nearest
            return self._shared(width, height)
        if abs(width * before[1] / (height * before[0]) - 1) < 0.005:
            self._scale *= height / before[1]  # viser draws coarser or finer now; the page is as it was
            return None
        if height != before[1]:  # the page itself has another size; the user moved no seam
            return self._shared(width, height)
        return _layout(width / self._scale, height / self._scale, self._right)

    def _shared(self, width: int, height: int) -> PageLayout:
        """Sizes with the plots as wide as suits the page. width, height: of the view now, screen pixels."""
        assert self._scale is not None
        view, before = width / self._scale, self._right
        wanted = min(max(RIGHT, PLOTS_SHARE * (LEFT + view + before + SEAMS)), WIDEST)
        self._right = int(max(min(wanted, view + before - SHORT_PLAYER - MARGINS), NARROW))
        return _layout(view + before - self._right, height / self._scale, self._right)


def _layout(view_width: float, page_height: float, right: int) -> PageLayout:
    player = int(min(max(view_width - MARGINS, SHORT_PLAYER), PLAYER))
    return PageLayout(right, max(int((view_width - player) / 2), 0), player, int(page_height))


def chart_height(page_height: int, plots: int) -> int:
    """Height of each of so many charts that together fill a page of this height, px."""
    return int(min(max((page_height - PLOTS_HEAD - AXIS_NAME) / max(plots, 1) - CARD, LOWEST), HIGHEST))


def spectrum_height(page_height: int) -> int:
    """Height of the chart of the spectrum, px: half a page, or more if its boxes and the table of modes leave more."""
    return max(chart_height(page_height, 2), chart_height(page_height - MODES, 1))
