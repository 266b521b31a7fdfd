"""The files of assets/ that go into pages: scripts and styles."""

from __future__ import annotations

from functools import cache
from importlib import resources

EXPLORER = (  # what its page needs
    *("head.html", "icon.svg", "page.js", "page.css", "address.js", "parameters.js", "parameters.css"),
    *("plots.js", "plots.css", "study.js", "study.css", "runs.js", "runs.css", "exports.css", "wheel.css"),
    *("modal.css", "modal.js", "tour.js", "tour.css"),
)


@cache
def asset(name: str) -> str:
    """The text of a file in assets/. Raises FileNotFoundError, which names it, when this installation lacks it.

    assets/ holds no Python, and is found beside the package app: as a package of its own importlib would not find it in
    every kind of installation.
    """
    file = resources.files("app").joinpath("..", "assets", name)
    if not file.is_file():
        raise FileNotFoundError(f"This installation of Trackride lacks assets/{name}: install it anew.")
    return file.read_text(encoding="utf-8")


def check_assets() -> None:
    """Raises FileNotFoundError, which names it, when this installation lacks a file that the explorer's page needs."""
    for name in EXPLORER:
        asset(name)
