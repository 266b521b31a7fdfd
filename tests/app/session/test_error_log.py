"""Of errors of the same kind, one in a while is told."""

from __future__ import annotations

import logging

import pytest

from app.session.error_log import SAME_ERROR, Seldom, Throttle, kind_of


class Clock:
    now = 0.0

    def __call__(self) -> float:
        return self.now


def broken(text: str, kind: type[Exception] = ValueError) -> Exception:
    try:
        raise kind(text)
    except Exception as error:
        return error


def test_a_kind_is_type_and_place_not_text() -> None:
    assert kind_of(broken("one")) == kind_of(broken("other"))
    assert kind_of(broken("one")) != kind_of(broken("one", TypeError))
    with pytest.raises(ValueError, match="no number") as elsewhere:
        int("no number")
    assert kind_of(elsewhere.value) != kind_of(broken("one"))
    assert kind_of(ValueError("never raised")) == kind_of(ValueError("nor this"))


def test_each_kind_passes_once_in_a_while() -> None:
    clock = Clock()
    seldom = Seldom(clock)
    assert [seldom.passes(kind) for kind in ("a", "b", "a", "b", "a")] == [0, 0, None, None, None]
    clock.now = SAME_ERROR - 0.01
    assert seldom.passes("a") is None
    clock.now = SAME_ERROR
    assert [seldom.passes("a"), seldom.passes("b")] == [3, 1]
    assert seldom.passes("a") is None


def test_a_log_takes_one_error_of_each_kind_and_says_how_many_there_were(caplog: pytest.LogCaptureFixture) -> None:
    clock = Clock()
    log, throttle = logging.getLogger("trackride.test"), Throttle(clock)
    log.addFilter(throttle)
    try:
        for number in range(10):
            log.error("broken", exc_info=broken(f"text {number}"))
            log.warning("strange %d", number)
        clock.now = SAME_ERROR
        log.error("broken: %s", "again", exc_info=broken("text"))
    finally:
        log.removeFilter(throttle)
    assert caplog.messages == ["broken", "strange 0", "broken: again (9 more of this kind were left out)"]
