"""The plots as a user sees them: one cursor, one zoom, values at the cursor, and what stands in the other tabs."""

from __future__ import annotations

import json
import re
from itertools import pairwise

from playwright.sync_api import Page, expect

from tests.browser.driver import NEW_CURVES, Explorer

CHARTS = """() => Object.values(__viserTestpoints.uplots).map(entry => entry.chart)
    .filter(chart => chart.over.offsetParent && chart.cursor.sync.key === 'trackride-time')"""
RANGES = f"() => ({CHARTS})().map(chart => [chart.scales.x.min, chart.scales.x.max])"
CURSORS = f"""() => ({CHARTS})().map(chart => {{
    const line = chart.over.querySelector('.trackride-marks i');
    return chart.posToVal(new DOMMatrix(getComputedStyle(line).transform).m41, 'x');
}})"""
MAP = """() => {  // the stretch of time that is seen, s
    const field = document.querySelector('.trackride-map .field').getBoundingClientRect();
    const picture = document.querySelector('.trackride-map img.far').style, part = 100 / parseFloat(picture.width);
    const from = -parseFloat(picture.marginLeft) / 100 * part;
    return field.width ? [10 * from, 10 * (from + part)] : [];
}"""
VALUES = f"""() => ({CHARTS})().map(chart => [...chart.root.querySelectorAll('.u-series:not(.static) .u-value')]
    .slice(1).map(value => parseFloat(value.textContent)))"""

WRONG = f"""() => ({CHARTS})().flatMap(chart => {{  // [what is told of a curve at the cursor, where it is elsewhere]
  const [now] = document.querySelector("trackride-marks[for='trackride-time']").getAttribute('at').match(/[\\d.]+/);
  const x = chart.data[0], after = x.findIndex(time => time >= now), [from, to] = [x[after - 1], x[after]];
  return [...chart.root.querySelectorAll('.u-series.run')].map((row, k) => {{
    const [low, high] = [after - 1, after].map(point => chart.data[k + 1][point]);
    return [row.querySelector('.u-value').textContent, low + (high - low) * (now - from) / (to - from)];
  }}).filter(([told, value]) => !(Math.abs(told - value) <= 0.5 / 10 ** (told.split('.')[1]?.length ?? 0) + 1e-6));
}})"""

# The named curves of the first chart at these values, its other ones at 1
DRAW = f"""([names, values]) => {{
  const chart = ({CHARTS})()[0], x = values.map((_, k) => 10 * k / (values.length - 1));
  const drawn = chart.series.slice(1).map(curve => curve.class === 'run' && names.includes(curve.label));
  chart.setData([x, ...drawn.map(it => it ? values : x.map(() => 1))]);
}}"""
# Of a column of pixels near its left end the upper half, as [red, green, blue, alpha]
COLUMN = f"""() => {{
  const chart = ({CHARTS})()[0], {{left, top, width, height}} = chart.bbox;
  const {{data}} = chart.ctx.getImageData(left + 0.05 * width, top, 1, height / 2);
  return Array.from({{length: height / 2}}, (_, k) => [...data.slice(4 * k, 4 * k + 4)]);
}}"""
# How thick a coloured line in the column is, px
INK = f"""() => ({COLUMN})().filter(([r, g, b]) => Math.max(r, g, b) - Math.min(r, g, b) > 60)
  .reduce((sum, [, , , alpha]) => sum + alpha / 255, 0)"""
COLOUR = f"""(name) => {{  // of the line in the column, and its distance to a curve's own
  const chart = ({CHARTS})()[0], k = chart.series.findIndex(curve => curve.label === name && curve.class === 'run');
  const own = chart.series[k].stroke(chart, k).match(/[0-9a-f]{{2}}/g).map(part => parseInt(part, 16));
  const seen = ({COLUMN})().reduce((most, pixel) => pixel[3] > most[3] ? pixel : most);
  return Math.hypot(...own.slice(0, 3).map((part, j) => part - seen[j]));
}}"""

TELL_PEAKS = """(peaks) => {
  const told = document.createElement('trackride-peaks');
  told.setAttribute('at', peaks);
  document.body.append(told);
  told.remove();
}"""
NO_PEAKS = '{"kN": []}'
# How opaque the first chart is at 5.001 s and a number on its axis, 0…255
DOT = f"""value => {{
  const chart = ({CHARTS})()[0], [x, y] = [chart.valToPos(5.001, 'x', true), chart.valToPos(value, 'y', true)];
  return [...chart.ctx.getImageData(x, y, 1, 1).data][3];
}}"""


def show(page: Page, tab: str) -> None:
    page.get_by_role("tab", name=tab, exact=True).click()


def test_the_page_tells_which_tab_is_in_front(at_rest: Explorer) -> None:
    page = at_rest.page
    for tab in ("Ride", "Load map", "Loads"):
        show(page, tab)
        page.wait_for_function(
            "tab => document.querySelector('[data-trackride=page] + div + div input').value === tab", arg=tab
        )


def test_zoom_in_one_plot_is_the_zoom_of_all_over_tabs_and_runs(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    box = page.locator(".u-over:visible").first.bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 0.3 * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], y, steps=4)
    page.mouse.up()
    zoomed = f"() => ({RANGES})().every(([from, to]) => Math.abs(from - 3) < 0.1 && Math.abs(to - 6) < 0.1)"
    page.wait_for_function(zoomed)
    show(page, "Ride")
    page.wait_for_function(f"() => ({RANGES})().length === 4")
    page.wait_for_function(zoomed)
    before = at_rest.run_number()
    curves = page.locator(".uplot canvas:visible").first.evaluate("canvas => canvas.toDataURL()")
    at_rest.press("Speed", "ArrowRight")
    at_rest.wait_for_run(after=before)
    page.wait_for_function(
        "old => [...document.querySelectorAll('.uplot canvas')].find(c => c.offsetParent).toDataURL() !== old",
        arg=curves,
    )
    page.wait_for_function(zoomed)

    show(page, "Load map")
    page.wait_for_function(f"() => Math.abs(({MAP})()[0] - 3) < 0.1 && Math.abs(({MAP})()[1] - 6) < 0.1")
    picture = page.locator(".trackride-map img.far").first
    at_rest.wait_until_still(lambda: picture.get_attribute("src"))  # the new run's map has come
    box = page.locator(".trackride-map .field").first.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 10)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.98 * box["width"], box["y"] + 10, steps=4)
    page.mouse.up()
    page.wait_for_function(f"() => ({MAP})()[0] > 4.3")
    for tab, plots in (("Ride", 4), ("Loads", 3)):
        show(page, tab)
        page.wait_for_function(
            f"count => ({RANGES})().length === count && ({RANGES})().every(([from, to]) => from > 4.3 && to < 6.1)",
            arg=plots,
        )
    page.locator(".u-over:visible").first.dblclick()
    page.wait_for_function(f"() => ({RANGES})().every(([from, to]) => from < 0.1 && to > 9.9)")
    show(page, "Load map")
    page.wait_for_function(f"() => ({MAP})()[0] < 0.1 && ({MAP})()[1] > 9.9")


def test_a_plot_is_read_by_keyboard(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    plot, told = page.locator(".u-over:visible").first, page.locator(".trackride-said")
    page.get_by_role("button", name="Large").locator("visible=true").first.focus()
    page.keyboard.press("Tab")
    expect(plot).to_be_focused()
    expect(plot).to_have_accessible_name(re.compile("^Normal load of road wheels.*arrow keys move the cursor"))
    expect(told).to_have_text(re.compile(r"^0\.00 s: R1 \d+\.\d+, R2 .* kN$"))
    page.keyboard.press("Shift+ArrowRight")
    expect(told).to_have_text(re.compile(r"^0\.[1-9]\d s: "))
    page.keyboard.press("End")
    expect(told).to_have_text(re.compile(r"^10\.00 s: "))
    at_rest.wait_for_value("Time, s", "now === 0")  # the run is not stepped through meanwhile
    page.keyboard.press("Enter")
    at_rest.wait_for_value("Time, s", "now === 10")
    page.keyboard.press("Escape")
    expect(plot).not_to_be_focused()


def test_one_cursor_goes_through_all_plots_and_the_values_at_it_are_shown(at_rest: Explorer) -> None:
    page = at_rest.page
    for tab, plots in (("Loads", 3), ("Ride", 4)):
        show(page, tab)
        at_rest.press("Time, s", "Home")
        page.wait_for_function(
            f"() => ({CURSORS})().length === {plots} && ({CURSORS})().every(t => Math.abs(t) < 0.05)"
        )
        at_rest.press("Time, s", "End")
        page.wait_for_function(f"() => ({CURSORS})().every(t => Math.abs(t - 10) < 0.05)")
        page.wait_for_function(f"() => ({VALUES})().flat().every(value => Number.isFinite(value))")
        assert [len(values) for values in page.evaluate(VALUES)] == ([6, 5, 1] if tab == "Loads" else [1, 1, 1, 6])


def test_the_values_at_the_cursor_lie_on_the_curves_between_the_points_that_are_drawn(at_rest: Explorer) -> None:
    page = at_rest.page
    at_rest.box("Time, s").fill("4.71")  # where loads change fast
    at_rest.box("Time, s").press("Enter")
    at_rest.wait_for_value("Time, s", "now === 4.71")
    for tab in ("Loads", "Ride"):
        show(page, tab)
        page.wait_for_function(f"() => ({CHARTS})().length > 2 && ({WRONG})().length === 0")


def test_peaks_between_samples_are_dots_that_the_axis_reaches(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    own = page.locator("trackride-peaks[at*=kN]").get_attribute("at") or ""
    assert [name for name, _, _ in json.loads(own)["kN"]] == [
        *(f"R{k}" for k in range(1, 7)),
        *(f"I{k}" for k in range(1, 6)),
    ]
    page.evaluate(TELL_PEAKS, json.dumps({"kN": [["R2", 5.001, 600.0]]}))
    reached = f"() => ({CHARTS})()[0].scales.y.max > 600"
    page.wait_for_function(reached)
    page.wait_for_function(f"() => ({DOT})(600) === 255 && ({DOT})(500) === 0")
    name = page.locator(".uplot:visible").first.locator(".u-series.run th", has_text="R2")
    name.click()  # hidden with its curve
    page.wait_for_function(f"() => ({CHARTS})()[0].scales.y.max < 600")
    name.click()
    page.wait_for_function(reached)
    page.evaluate(TELL_PEAKS, own)
    page.wait_for_function(f"() => ({CHARTS})()[0].scales.y.max < 600")


def tool(page: Page, name: str) -> None:
    page.locator("trackride-tools:visible").get_by_role("button", name=name).click()


def test_curves_are_thicker_than_a_pixel_where_there_is_room(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    tool(page, "Curves")
    page.evaluate(TELL_PEAKS, NO_PEAKS)
    page.evaluate(DRAW, [["R2"], [8] * 200])
    page.wait_for_function(f"() => ({INK})() > 1.25 && ({INK})() < 2")
    page.evaluate(DRAW, [["R2"], [8] * 50 + [0, 8] * 225])
    page.wait_for_function(f"() => ({INK})() > 0.5 && ({INK})() < 1.1")
    tool(page, "Auto")


def test_curves_that_crowd_become_strips_and_others_on_demand(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    shape = f"shape => ({CHARTS})()[0].root.dataset.shape === shape"
    smooth, rough = [8] * 200, [8] * 50 + [0, 8] * 225
    page.evaluate(DRAW, [["R1", "R2", "R3", "R4", "R5", "R6"], smooth])
    page.wait_for_function(shape, arg="curves")
    page.evaluate(DRAW, [["R1", "R2", "R3", "R4", "R5", "R6"], rough])
    page.wait_for_function(shape, arg="strips")
    for name in ("Band", "Curves", "Strips", "Auto"):
        tool(page, name)
        page.wait_for_function(shape, arg="strips" if name == "Auto" else name.lower())
        expect(page.locator("trackride-tools:visible").get_by_role("button", name=name, pressed=True)).to_be_visible()
    before = at_rest.curves()
    tool(page, "Curves")
    tool(page, "Names")
    page.wait_for_function(NEW_CURVES, arg=before)
    tool(page, "Names")
    tool(page, "Auto")


def test_a_click_in_a_plot_goes_to_that_time_which_stands_in_figures_at_the_cursor(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    over = page.locator(".u-over:visible").first
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 20)
    expect(over.locator(".trackride-at")).to_have_text(re.compile(r"^(4\.9|5\.0)\d s$"))
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 20)
    at_rest.wait_for_value("Time, s", "Math.abs(now - 5) < 0.1")
    page.mouse.move(640, 60)
    expect(over.locator(".trackride-at")).to_be_hidden()


def test_plots_open_large_by_a_key_side_by_side_and_zoom_by_wheel(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    at_rest.status.click()  # no box has the keys
    page.keyboard.press("l")
    first, second = (page.locator(".u-over:visible").nth(k) for k in range(2))
    page.wait_for_function("() => document.documentElement.dataset.plots === 'large'")
    at_rest.wait_until_still(lambda: (first.bounding_box(), second.bounding_box()))
    one, other = first.bounding_box(), second.bounding_box()
    assert one is not None
    assert other is not None
    assert one["y"] == other["y"]
    assert one["x"] + one["width"] < other["x"]
    page.mouse.move(one["x"] + 0.5 * one["width"], one["y"] + 20)
    page.mouse.wheel(0, -100)
    page.wait_for_function(f"() => ({RANGES})().every(([from, to]) => from > 0.5 && to < 9.5)")
    first.dblclick()
    page.wait_for_function(f"() => ({RANGES})().every(([from, to]) => from < 0.1 && to > 9.9)")
    tool(page, "Large")
    page.wait_for_function("() => document.documentElement.dataset.plots === 'beside'")
    at_rest.wait_until_still(lambda: first.bounding_box())


def test_names_of_frequencies_do_not_overlap(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Spectrum")
    marks = json.dumps([[1.1, "Bounce 1.10 Hz"], [1.05, "Pitch 1.05 Hz"], [1.0, "v/λ 1.00 Hz"]])
    page.evaluate(
        """at => {
          const told = document.createElement('trackride-marks');
          told.setAttribute('for', 'trackride-frequency');
          told.setAttribute('at', at);
          document.body.append(told);
          told.remove();
        }""",
        marks,
    )
    rows = """() => [...document.querySelectorAll('.trackride-frequency .trackride-marks i')].map(line => {
      const {top, height} = getComputedStyle(line, '::after');
      return [line.dataset.name, parseFloat(top), parseFloat(height)];
    })"""
    page.wait_for_function(f"() => ({rows})()[2]?.[0] === 'v/λ 1.00 Hz'")
    places = page.evaluate(rows)
    for (_, top, height), (_, below, _) in pairwise(places):
        assert top + height <= below + 1
    show(page, "Loads")


def test_a_wheel_whose_name_is_pointed_at_is_drawn_in_front(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    page.evaluate(TELL_PEAKS, NO_PEAKS)
    page.evaluate(DRAW, [["R2", "R6"], [8] * 3])  # the later one covers the other
    page.wait_for_function(f"() => ({COLOUR})('R6') < 30 && ({COLOUR})('R2') > 60")
    page.locator(".uplot:visible").first.locator(".u-series.run th", has_text="R2").hover()
    page.wait_for_function(f"() => ({COLOUR})('R2') < 30")
    page.mouse.move(640, 60)
    page.wait_for_function(f"() => ({COLOUR})('R6') < 30")


def test_the_ride_is_told_in_a_line_and_in_tables(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Ride")
    expect(page.locator(".trackride-comfort:visible")).to_contain_text("uncomfortable")
    tables = page.locator(".trackride-page:visible .felt")
    expect(tables).to_have_count(2)
    expect(tables.first).to_contain_text("Absorbed power, W")


def test_thin_lines_show_from_which_stretch_the_figures_are_taken(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Ride")
    page.wait_for_function(f"() => ({CHARTS})().every(chart => chart.over.querySelector('.trackride-window'))")
    ends = page.evaluate(f"""() => ({CHARTS})().map(chart => {{
        const {{offsetLeft: left, offsetWidth: width}} = chart.over.querySelector('.trackride-window b');
        return [chart.posToVal(left, 'x'), chart.posToVal(left + width, 'x')];
    }})""")
    assert len(ends) == 4
    for start, end in ends:  # of the paper's run: its last three waves
        assert abs(start - 4.96) < 0.05
        assert abs(end - 10) < 0.05


def test_a_mode_swings_in_the_3d_view_until_the_run_is_played(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Spectrum")
    choice = at_rest.control("Show in 3-D")
    choice.click()
    page.get_by_role("option", name="Bounce").click()
    expect(at_rest.status).to_contain_text("shown at 1 Hz")
    page.wait_for_function("() => '/ghost' in __viserMutable.nodePoseData")
    at_rest.button("Play").click()
    expect(at_rest.status).to_contain_text("real time")
    page.wait_for_function("() => !('/ghost' in __viserMutable.nodePoseData)")
    expect(choice).to_have_value("– the run –")
    at_rest.pause()


def test_a_wheel_hidden_in_a_plot_takes_its_baseline_along(at_rest: Explorer) -> None:
    page = at_rest.page
    show(page, "Loads")
    before = at_rest.run_number()
    page.locator(".trackride-status").click()  # no box has the keys
    page.keyboard.press("b")
    at_rest.press("Speed", "ArrowLeft")
    at_rest.wait_for_run(after=before)
    hidden = f"() => ({CHARTS})()[0].series.filter(curve => !curve.show).map(curve => curve.label + curve.class).sort()"
    page.wait_for_function(f"() => ({CHARTS})()[0].series.some(curve => curve.class === 'baseline')")
    name = page.locator(".uplot:visible").first.locator(".u-series.run th", has_text="R2")
    name.click()
    page.wait_for_function(f"() => ({hidden})().join() === 'R2baseline,R2run'")
    name.click()
    page.wait_for_function(f"() => ({hidden})().length === 0")


def clear_baseline(explorer: Explorer) -> None:
    show(explorer.page, "Runs")
    explorer.button("Clear").click()
    show(explorer.page, "Loads")
    explorer.page.wait_for_function(
        f"() => ({CHARTS})().length === 3 && ({CHARTS})()[0].series.every(curve => curve.class !== 'baseline')"
    )


def test_charts_that_are_made_anew_while_a_run_plays_have_the_numbers_of_their_axes(at_rest: Explorer) -> None:
    page = at_rest.page
    clear_baseline(at_rest)
    at_rest.button("▶ Play").click()
    expect(at_rest.button("Pause")).to_be_visible()  # of two controls used within 50 ms viser tells the last one only
    before = at_rest.run_number()
    at_rest.press("Speed", "ArrowRight")
    at_rest.wait_for_run(after=before)
    old = page.evaluate_handle(f"() => ({CHARTS})()[0]")
    page.locator(".trackride-status").click()  # no box has the keys
    page.keyboard.press("b")
    page.wait_for_function(f"old => ({CHARTS})().length === 3 && ({CHARTS})()[0] !== old", arg=old)
    numbered = f"() => ({CHARTS})().every(({{axes}}) => axes.every(axis => axis._values?.length > 2))"
    page.wait_for_function(numbered)
    page.evaluate(f"() => ({CHARTS})().forEach(({{axes}}) => axes[0]._values = undefined)")  # happens now and then
    page.wait_for_function(numbered)
    clear_baseline(at_rest)
    at_rest.pause()


def test_the_other_tabs_show_spectrum_map_trust_and_equations(at_rest: Explorer) -> None:
    page = at_rest.page
    page.keyboard.press("b")  # a baseline, whose load maps stand under the run's
    show(page, "Spectrum")
    names = page.locator(".trackride-frequency .trackride-marks i")
    expect(names).to_have_count(3)
    assert "Bounce" in names.first.get_attribute("data-name")
    expect(page.locator(".trackride-modes:visible")).to_contain_text("hull up and down")
    show(page, "Load map")
    pictures = page.locator(".trackride-map img.far")
    expect(pictures).to_have_count(4)  # the baseline's too
    assert [picture.evaluate("img => img.naturalHeight") for picture in pictures.all()] == [6, 6, 5, 5]
    page.wait_for_function(
        """() => {
          const box = (css) => document.querySelector(css).getBoundingClientRect();
          const cursor = box(".trackride-map .field i"), field = box(".trackride-map .field");
          return field.left - 2 <= cursor.left && cursor.left <= field.right + 2;
        }"""
    )
    show(page, "Trust")
    expect(page.get_by_text("Energy unaccounted for")).to_be_visible()
    expect(page.locator(".trackride-facts .good")).to_have_count(3)
    show(page, "About")
    expect(page.locator(".trackride-formula sub").first).to_be_visible()
    assert page.locator(".trackride-parameters:visible").count() == 7
