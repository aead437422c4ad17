"""Where a plan is watched: a page in a browser, served by a thread of this process on this machine alone."""

from __future__ import annotations

import json
import os
import sys
import threading
import webbrowser
from typing import Protocol

from robotraj._util.system.own_python import without_working_folder
from robotraj.replay_page.live.event_log import EventLog
from robotraj.replay_page.live.page_server import PageServer

Event = dict[str, object]

ARRIVAL = 10.0
"""Longest wait for a browser before planning, and for the last events to arrive after it [s]."""


class LiveWindow(Protocol):
    """What shows a plan while it is made. Any object with these methods can be given as ``watch=``."""

    def open(self, page: str) -> None:
        """Show the page, a text in HTML."""

    def send(self, event: Event) -> None:
        """Pass an event to the page: values that JSON can hold."""

    def close(self) -> None:
        """No event follows."""


class BrowserWindow:
    """A page at an address of this machine, opened in the browser where there is a screen.

    A thread serves the page and its events (``text/event-stream``). No process is started, and the threads end with
    ``close``. The address holds a secret: other users of the machine, and pages of other sites, are refused.

    Parameters
    ----------
    show : bool, optional
        Whether a browser is opened; by default where this machine has a screen.
    wait : float
        Longest wait for a browser [s].
    """

    def __init__(self, show: bool | None = None, wait: float = ARRIVAL) -> None:
        self._show, self._wait = _has_screen() if show is None else show, wait
        self._events = EventLog()
        self._server: PageServer | None = None
        self.address = ""

    def open(self, page: str) -> None:
        """Serve the page, open a browser, and wait until it asks for events."""
        self._server = PageServer(page, self._events)
        self.address = self._server.address
        threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        print(f"Watch the plan at {self.address}", file=sys.stderr)
        if self._show:
            with without_working_folder():
                webbrowser.open(self.address)
            self._events.wait_for_listener(self._wait)

    def send(self, event: Event) -> None:
        """Pass an event to the page; a browser that comes later gets the earlier ones too."""
        self._events.add(f"data: {json.dumps(event, allow_nan=False)}\n\n".encode())

    def close(self) -> None:
        """Let the last events arrive, and end the threads."""
        self._events.end(self._wait)
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            self._server = None


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
