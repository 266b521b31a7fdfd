"""How the panels share pages of all sizes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from app.panels import playback_panel, wheel_card
from app.panels.page_layout import AXIS_NAME, CARD, HIGHEST, LOWEST, MODES, PLOTS_HEAD, SEAMS, page_layout
from app.panels.playback_panel import covered, player_height
from app.view3d.camera import CameraPose, Standpoint, camera_pose
from app.view3d.meshes.hull import hull_edges
from app.view3d.meshes.measures import measures_of
from model import load_config
from model.dynamics.vehicle import build_system

WIDE = [(1280, 720), (1600, 900), (1920, 1080), (2560, 1440), (3440, 1440)]
NARROW = [(1024, 768), (768, 1024)]


@pytest.mark.parametrize(("width", "height"), [*WIDE, *NARROW])
def test_the_view_is_wider_and_higher_than_a_third_of_the_page_and_the_player_in_its_middle(
    width: int, height: int
) -> None:
    sizes = page_layout(width, height)
    view = width - sizes.left - SEAMS - (sizes.right if sizes.plots == "beside" else 0)
    assert view > width / 3
    assert sizes.player_width <= view
    assert sizes.player_x + sizes.player_width / 2 == pytest.approx(view / 2, abs=2)
    assert sizes.plots == ("beside" if (width, height) in WIDE else "under")


@pytest.mark.parametrize(("width", "height"), NARROW)
def test_on_a_narrow_page_the_view_is_wider_and_higher_than_half_of_it(width: int, height: int) -> None:
    sizes = page_layout(width, height)
    assert width - sizes.left - SEAMS > width / 2
    assert height - sizes.below > height / 2
    assert sizes.plots_height == sizes.below
    assert sizes.right == width - sizes.left


def test_a_larger_page_has_larger_type_and_wider_panels() -> None:
    sizes = [page_layout(width, height) for width, height in ((1600, 900), (1920, 1080), (2560, 1440))]
    assert sizes[0].scale == 1.0
    for small, large in pairwise(sizes):
        assert large.scale > small.scale
        assert large.left > small.left
        assert large.right > small.right
        assert large.chart_height(3) > small.chart_height(3)
    assert page_layout(1280, 720).scale == 1.0


def test_a_seam_that_is_moved_moves_only_the_player() -> None:
    sizes, moved = page_layout(1600, 900), page_layout(1600, 900, 500)
    assert moved.player_x + moved.player_width / 2 == pytest.approx(250, abs=1)
    assert (moved.left, moved.right, moved.plots_height) == (sizes.left, sizes.right, sizes.plots_height)


def test_large_plots_leave_room_for_the_player_and_stand_side_by_side() -> None:
    for width, height in WIDE:
        sizes = page_layout(width, height, large=True)
        assert sizes.columns >= 2
        assert sizes.plots_height + player_height(sizes) + playback_panel.GAP < height
        assert sizes.chart_height(3) > page_layout(width, height).chart_height(3) or sizes.columns > 2


@pytest.mark.parametrize(("height", "plots"), [(720, 3), (720, 4), (900, 4), (900, 2)])
def test_charts_fill_the_page_below_each_other(height: int, plots: int) -> None:
    sizes = page_layout(1280, height)
    taken = PLOTS_HEAD + AXIS_NAME + plots * (sizes.chart_height(plots) + CARD)
    assert 0 <= height - taken < plots


def test_charts_stay_usable_on_any_page() -> None:
    assert page_layout(1280, 300).chart_height(3) == LOWEST
    assert page_layout(1280, 5000).chart_height(2) == HIGHEST


def test_the_spectrum_takes_what_the_modes_leave_of_a_tall_page_and_half_of_a_low_one() -> None:
    low, tall = page_layout(1280, 720), page_layout(1280, 1250)
    assert low.spectrum_height() == low.chart_height(2)
    assert tall.spectrum_height() == 1250 - MODES - PLOTS_HEAD - AXIS_NAME - CARD > tall.chart_height(2)
    assert page_layout(1280, 5000).spectrum_height() == HIGHEST


def heights_in_picture(points: np.ndarray, stood: CameraPose, height: int) -> np.ndarray:
    """px from the upper edge of a picture of this height."""
    ahead = stood.look_at - stood.position
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    up = np.cross(right / np.linalg.norm(right), ahead)
    seen = points - stood.position
    return height / 2 * (1 - (seen @ up) / (seen @ ahead) / np.tan(stood.fov / 2))


@pytest.mark.parametrize("standpoint", ["side", "three-quarter", "front"])
@pytest.mark.parametrize(("width", "height"), [*WIDE, *NARROW])
def test_the_player_does_not_hide_the_vehicle_nor_does_the_card_where_there_is_room(
    width: int, height: int, standpoint: Standpoint
) -> None:
    sizes = page_layout(width, height)
    view_height = height - sizes.below
    view = width - sizes.left - SEAMS - (sizes.right if sizes.plots == "beside" else 0)
    measures = measures_of(build_system(load_config("paper")), "turret")
    stood = camera_pose(standpoint, measures, view / view_height, covered(sizes))
    upper = heights_in_picture(np.concatenate(hull_edges(measures)), stood, view_height).min()
    assert upper > (wheel_card.GAP + wheel_card.HEIGHT * sizes.scale if sizes.plots == "beside" else 0)
    feet = np.array([(x, y, 0.0) for x in (measures.rear, measures.front) for y in (-measures.arrow, measures.arrow)])
    player = view_height - playback_panel.GAP - player_height(sizes)
    assert heights_in_picture(feet, stood, view_height).max() < player
