"""Elements and tables, whose text is escaped, and formulas."""

from __future__ import annotations

from html.parser import HTMLParser

import pytest

from app.format.assets import asset
from app.format.markup import (
    Content,
    Html,
    cell,
    element,
    formula_html,
    heading_cell,
    joined,
    page,
    row,
    running,
    style,
    table,
    words_html,
)

NASTY = """<script>alert('"&amp;"')</script>"""


class Reader(HTMLParser):
    """Takes HTML apart as a browser does."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[dict[str, str | None]] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes.append(dict(attrs))

    def handle_data(self, data: str) -> None:
        self.text += data


def test_text_and_attributes_come_out_as_they_went_in() -> None:
    read = Reader(str(element("p", NASTY, title=NASTY, class_=NASTY)))
    assert (read.tags, read.text) == (["p"], NASTY)
    assert read.attributes == [{"title": NASTY, "class": NASTY}]
    assert str(element("p", "a<b", Html("<i>c</i>"))) == "<p>a&lt;b<i>c</i></p>"


@pytest.mark.parametrize(
    "made",
    [
        table([NASTY], []),
        table([], [[NASTY]]),
        table([], [["", NASTY]]),
        table([], [["", NASTY]], titled=False),
        table([""], [], over=[NASTY]),
        table([], [[cell(NASTY)]]),
        table([], [[heading_cell(NASTY)]]),
        table([], [row([NASTY])]),
        joined((NASTY,)),
        page(NASTY),
        formula_html(f'"{NASTY.replace(chr(34), "")}"'),
    ],
)
def test_no_text_becomes_an_element(made: Content) -> None:
    read = Reader(str(made))
    assert "script" not in read.tags
    assert read.text.replace('"', "") == NASTY.replace('"', "")


def test_a_table_has_its_heads_and_the_headings_of_its_rows() -> None:
    rows = [["a", "1", cell("2", class_="more")], row(["b", "3", "4"], title="hint")]
    made = str(table(["", "x", "y"], rows, "facts", over=["", heading_cell("both", colspan="2")]))
    assert made == (
        '<table class="facts"><thead><tr><th></th><th colspan="2">both</th></tr><tr><th></th><th>x</th><th>y</th></tr>'
        '</thead><tbody><tr><th>a</th><td>1</td><td class="more">2</td></tr>'
        '<tr title="hint"><th>b</th><td>3</td><td>4</td></tr></tbody></table>'
    )
    assert str(table([], [["a", "1"]], titled=False)) == "<table><tbody><tr><td>a</td><td>1</td></tr></tbody></table>"


def test_what_is_left_out_of_an_element() -> None:
    assert str(element("br")) == "<br>"
    assert str(element("img", alt="", src=None)) == '<img alt="">'
    assert str(element("i", aria_label="x")) == '<i aria-label="x"></i>'


@pytest.mark.parametrize("name", ["page.js", "plots.js"])
def test_a_script_of_the_page_stays_in_its_attribute(name: str) -> None:
    read = Reader(str(running(asset(name))))
    assert read.tags == ["img"]
    assert read.attributes[0]["onerror"] == asset(name)


@pytest.mark.parametrize("name", ["page.css", "plots.css", "runs.css", "modal.css", "wheel.css", "report.css"])
def test_rules_stay_in_their_element(name: str) -> None:
    assert "</" not in asset(name)
    assert Reader(str(style(asset(name)))).text == asset(name)


def test_formulas_are_set_as_in_print() -> None:
    assert str(formula_html("k_s θ̇_i²")) == "<i>k</i><sub>s</sub> <i>θ̇</i><sub>i</sub>²"
    assert str(formula_html("max(0, f_n)")) == "max(0, <i>f</i><sub>n</sub>)"
    assert (
        str(formula_html("(C_q q̇)_q + τ′_0")) == "(<i>C</i><sub>q</sub> <i>q̇</i>)<sub>q</sub> + <i>τ′</i><sub>0</sub>"
    )
    assert str(formula_html('a "limited to" b < c')) == "<i>a</i> limited to <i>b</i> &lt; <i>c</i>"
    assert str(formula_html("C_{tt} C_qᵀ")) == "<i>C</i><sub>tt</sub> <i>C</i><sub>q</sub>ᵀ"
    assert str(words_html("the c_sl of paper_0583 & more")) == "the <i>c</i><sub>sl</sub> of paper_0583 &amp; more"
