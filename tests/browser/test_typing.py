"""Boxes never lie: a typed value counts once, what is no value is refused, and the box shows what is used."""

from __future__ import annotations

from playwright.sync_api import Locator, expect

from tests.browser.driver import Explorer

KEY = 70  # ms from one key to the next: more than viser gathers, less than a pause


def box(explorer: Explorer, label: str) -> Locator:
    """The box behind a label, whatever is typed there."""
    name = explorer.page.locator("label").filter(has_text=label).first
    return name.locator("xpath=ancestor::div[.//input][1]").locator("input:not([type=hidden])").first


def type_into(explorer: Explorer, label: str, text: str, end: str = "Enter") -> Locator:
    """Type a text in place of what stands there."""
    found = box(explorer, label)
    found.click()
    explorer.page.keyboard.press("Control+a")
    if text:
        found.press_sequentially(text, delay=KEY)
    else:
        explorer.page.keyboard.press("Delete")
    if end:
        explorer.page.keyboard.press(end)
    return found


def test_a_typed_value_is_one_run_at_enter_on_leaving_and_after_a_pause(at_rest: Explorer) -> None:
    for text, end in (("22.5", "Enter"), ("31.5", "Tab"), ("42.5", "")):
        before = at_rest.run_number()
        type_into(at_rest, "Speed, km/h", text, end)
        at_rest.wait_for_value("Speed, km/h", "now === value", float(text))
        assert at_rest.wait_for_run(after=before) == before + 1
    at_rest.status.click()
    at_rest.page.keyboard.press("Control+z")
    at_rest.wait_for_value("Speed, km/h", "now === value", 31.5)


def test_a_refused_value_leaves_what_was_there_before(at_rest: Explorer) -> None:
    before = at_rest.wait_until_still(at_rest.run_number)  # the run that came to rest after the test before
    for end in ("Enter", "Tab", ""):
        speed = type_into(at_rest, "Speed, km/h", "200", end)
        expect(at_rest.page.get_by_text("Speed: 200 km/h is not allowed. Give 0.5 to 100 km/h.")).to_be_visible()
        expect(speed).to_have_value("15")
        assert (at_rest.value("Speed, km/h"), at_rest.run_number()) == (15, before)
        at_rest.close_messages()
        expect(at_rest.messages).to_have_count(0)


def test_what_is_no_number_is_refused_and_not_misread(at_rest: Explorer) -> None:
    before = at_rest.wait_until_still(at_rest.run_number)
    for text, said in (
        ("", "Speed: a value is needed. Give 0.5 to 100 km/h."),
        ("abc", "Speed: 'abc' is not allowed. Give 0.5 to 100 km/h."),
        ("4.732/2", "Speed: '4.732/2' is not allowed."),
    ):
        speed = type_into(at_rest, "Speed, km/h", text)
        expect(at_rest.page.get_by_text(said)).to_be_visible()
        expect(speed).to_have_value("15")
        at_rest.close_messages()
        expect(at_rest.messages).to_have_count(0)
    assert at_rest.run_number() == before
    expect(type_into(at_rest, "Speed, km/h", "x1", "Escape")).to_have_value("15")
    expect(type_into(at_rest, "Speed, km/h", "1e1")).to_have_value("10")
    at_rest.wait_for_value("Speed, km/h", "now === value", 10)
    expect(type_into(at_rest, "Speed, km/h", "12.345678")).to_have_value("12.345678")
    at_rest.wait_for_value("Speed, km/h", "now === value", 12.345678)


def test_values_per_wheel_are_typed_and_shown(at_rest: Explorer) -> None:
    label, stiffness = "Suspension damping", "Suspension stiffness"
    before = at_rest.run_number()
    type_into(at_rest, label, "5, 0, 0, 0, 0, 5")
    assert at_rest.wait_for_run(after=before) == before + 1
    expect(box(at_rest, label)).to_have_value("5, 0, 0, 0, 0, 5")
    type_into(at_rest, label, "4, 1")
    expect(at_rest.page.get_by_text("Suspension damping: ")).to_be_visible()
    expect(box(at_rest, label)).to_have_value("5, 0, 0, 0, 0, 5")
    at_rest.close_messages()
    before = at_rest.run_number()
    type_into(at_rest, stiffness, "70, 75, 75, 75, 75, 80")
    at_rest.wait_for_run(after=before)
    expect(box(at_rest, stiffness)).to_have_value("70, 75, 75, 75, 75, 80")
    before = at_rest.run_number()
    type_into(at_rest, stiffness, "75")
    at_rest.wait_for_run(after=before)
    at_rest.wait_for_value(stiffness, "now === value", 75)


def test_a_slider_that_was_widened_has_its_range_again_after_a_reset(at_rest: Explorer) -> None:
    thumb = at_rest.thumb("Speed, km/h")
    ends = [thumb.get_attribute(name) for name in ("aria-valuemin", "aria-valuemax")]
    type_into(at_rest, "Speed, km/h", "95")
    expect(thumb).to_have_attribute("aria-valuemax", "95")
    at_rest.button("Reset").click()
    at_rest.wait_for_value("Speed, km/h", "now === value", 15)
    assert [thumb.get_attribute(name) for name in ("aria-valuemin", "aria-valuemax")] == ends
