"""Sizes of the panels, read off the size of the 3-D view."""

from __future__ import annotations

import numpy as np
import pytest

from app.panels import playback_panel, wheel_card
from app.panels.page_layout import (
    AXIS_NAME,
    CARD,
    HIGHEST,
    LEFT,
    LOWEST,
    MODES,
    NARROW,
    PLOTS_HEAD,
    RIGHT,
    SEAMS,
    WIDEST,
    Screen,
    chart_height,
    spectrum_height,
)
from app.view3d.camera import CameraPose, Standpoint, camera_pose
from app.view3d.meshes.hull import hull_edges
from app.view3d.meshes.measures import measures_of
from model import load_config
from model.dynamics.vehicle import build_system


@pytest.mark.parametrize("scale", [0.5, 1.0, 1.25, 1.5, 2.0])
@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1600, 900), (2560, 1440)])
def test_the_page_is_found_behind_the_view(width: int, height: int, scale: float) -> None:
    screen = Screen(int(width * scale), int(height * scale))
    assert screen.update(int(width * scale), int(height * scale)) is None
    docked = width - LEFT - RIGHT - SEAMS
    layout = screen.update(int(docked * scale), int(height * scale))
    assert layout is not None
    assert layout.page_height == pytest.approx(height, abs=2)
    assert RIGHT <= layout.right <= WIDEST
    view = width - LEFT - layout.right - SEAMS
    assert layout.player_width <= view
    middle = layout.player_x + layout.player_width / 2
    assert middle == pytest.approx(view / 2, abs=3)


def test_a_window_made_larger_or_smaller_shares_its_width_anew() -> None:
    screen = Screen(1280, 720)
    opened = screen.update(1280 - LEFT - RIGHT - SEAMS, 720)
    maximised = screen.update(2560 - LEFT - RIGHT - SEAMS, 1440)
    assert opened is not None
    assert maximised is not None
    assert (opened.right, maximised.right) == (RIGHT, WIDEST)
    assert maximised.player_x + maximised.player_width / 2 == pytest.approx((2560 - LEFT - WIDEST - SEAMS) / 2, abs=3)
    again = screen.update(1280 - LEFT - WIDEST - SEAMS, 720)
    assert again == opened


def test_in_a_narrow_window_the_plots_leave_room_for_the_player() -> None:
    screen = Screen(1024, 768)
    layout = screen.update(1024 - LEFT - RIGHT - SEAMS, 768)
    assert layout is not None
    assert NARROW <= layout.right < RIGHT
    assert layout.player_x + layout.player_width < 1024 - LEFT - layout.right - SEAMS


def test_a_seam_that_is_moved_stays_where_it_is() -> None:
    screen = Screen(1600, 900)
    opened = screen.update(1600 - LEFT - RIGHT - SEAMS, 900)
    moved = screen.update(1600 - LEFT - RIGHT - SEAMS - 200, 900)
    assert opened is not None
    assert moved is not None
    assert moved.right == opened.right


def test_half_docked_panels_tell_nothing() -> None:
    screen = Screen(1280, 720)
    assert screen.update(1280 - LEFT, 720) is None


def test_a_taller_page_makes_taller_charts_but_coarser_drawing_does_not() -> None:
    screen = Screen(1600, 900)
    view = 1600 - LEFT - RIGHT - SEAMS
    assert screen.update(view, 900) is not None
    assert screen.update(int(view * 0.75), 675) is None  # viser draws with fewer pixels
    taller = screen.update(int(view * 0.75), 900)
    assert taller is not None
    assert taller.page_height == pytest.approx(1200, abs=3)
    assert chart_height(1200, 3) > chart_height(900, 3)


@pytest.mark.parametrize(("height", "plots"), [(720, 3), (720, 4), (900, 4), (1000, 2), (1440, 4)])
def test_charts_fill_the_page_below_each_other(height: int, plots: int) -> None:
    taken = PLOTS_HEAD + AXIS_NAME + plots * (chart_height(height, plots) + CARD)
    assert 0 <= height - taken < plots or chart_height(height, plots) == HIGHEST


def test_charts_stay_usable_on_any_page() -> None:
    assert chart_height(300, 3) == LOWEST
    assert chart_height(5000, 2) == HIGHEST


def test_the_spectrum_takes_what_the_modes_leave_of_a_tall_page_and_half_of_a_low_one() -> None:
    assert spectrum_height(720) == chart_height(720, 2)
    assert spectrum_height(1200) == 1200 - MODES - PLOTS_HEAD - AXIS_NAME - CARD > chart_height(1200, 2)
    assert spectrum_height(5000) == HIGHEST


def heights_in_picture(points: np.ndarray, stood: CameraPose, height: int) -> np.ndarray:
    """px from the upper edge of a picture of this height."""
    ahead = stood.look_at - stood.position
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    up = np.cross(right / np.linalg.norm(right), ahead)
    seen = points - stood.position
    return height / 2 * (1 - (seen @ up) / (seen @ ahead) / np.tan(stood.fov / 2))


@pytest.mark.parametrize("standpoint", ["side", "three-quarter", "front"])
@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1600, 900), (1920, 1080), (2560, 1440), (3440, 1440)])
def test_neither_card_nor_player_hides_the_vehicle(width: int, height: int, standpoint: Standpoint) -> None:
    screen, docked = Screen(width, height), width - LEFT - RIGHT - SEAMS
    sizes = screen.update(docked, height)
    assert sizes is not None
    measures = measures_of(build_system(load_config("paper")), "turret")
    stood = camera_pose(standpoint, measures, (width - LEFT - sizes.right - SEAMS) / height)
    upper = heights_in_picture(np.concatenate(hull_edges(measures)), stood, height)
    assert upper.min() > wheel_card.GAP + wheel_card.HEIGHT
    feet = np.array([(x, y, 0.0) for x in (measures.rear, measures.front) for y in (-measures.arrow, measures.arrow)])
    assert heights_in_picture(feet, stood, height).max() < height - playback_panel.GAP - playback_panel.HEIGHT
