"""Notifications of one tab, one of each kind: a newer one takes the older one's place."""

from __future__ import annotations

from typing import Any

import viser

NOTIFICATION_TIME = 10.0  # s that a notification stays


class Notifications:
    """What the user is told beside the panels."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._shown: dict[str, viser.NotificationHandle] = {}  # by kind

    def __len__(self) -> int:
        return len(self._shown)

    def show(self, kind: str, title: str, body: str, color: Any, stays: bool = False) -> None:
        """Tell something, for a while or until it is forgotten."""
        notice = self._shown.get(kind)
        if notice is not None and (notice.title, notice.body) == (title, body) and stays:
            return
        self.forget(kind)
        self._shown[kind] = self._client.add_notification(
            title, body, color=color, auto_close_seconds=None if stays else NOTIFICATION_TIME
        )

    def forget(self, kind: str) -> None:
        """Take back what was told last of a kind."""
        notice = self._shown.pop(kind, None)
        if notice is not None:
            notice.remove()
