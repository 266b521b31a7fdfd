"""What viser calls when the user does something."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any


def by_user(act: Callable[[Any], None], fail: Callable[[Exception], None]) -> Callable[[Any], Coroutine]:
    """A callback for viser's event loop, where events come in order: calls act(event), which must not block.

    Changes that this program made itself are left out; exceptions go to `fail`.
    """

    async def callback(event: Any) -> None:
        if event.client_id is None:
            return
        try:
            act(event)
        except Exception as error:
            fail(error)

    return callback
