"""Where a plan is watched: a page in a browser, served by a thread of this process on this machine alone."""

from __future__ import annotations

import json
import os
import queue
import sys
import threading
import webbrowser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Protocol

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

    A thread serves the page and its events (``text/event-stream``). No process is started, and the thread ends with
    ``close``.

    Parameters
    ----------
    show : bool, optional
        Whether a browser is opened; by default where this machine has a screen.
    wait : float
        Longest wait for a browser [s].
    """

    def __init__(self, show: bool | None = None, wait: float = ARRIVAL) -> None:
        self._show, self._wait = _has_screen() if show is None else show, wait
        self._events: queue.Queue[Event | None] = queue.Queue()
        self._arrived, self._delivered = threading.Event(), threading.Event()
        self._server: ThreadingHTTPServer | None = None
        self.address = ""

    def open(self, page: str) -> None:
        """Serve the page, open a browser, and wait until it asks for events."""
        self._server = _Server(self, page)
        host, port = self._server.server_address[:2]
        self.address = f"http://{host!s}:{port}/"
        threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        print(f"Watch the plan at {self.address}", file=sys.stderr)
        if self._show:
            webbrowser.open(self.address)
            self._arrived.wait(self._wait)

    def send(self, event: Event) -> None:
        """Pass an event to the page; events before the browser comes are kept for it."""
        self._events.put(event)

    def close(self) -> None:
        """Let the last events arrive, and end the thread."""
        self._events.put(None)
        if self._arrived.is_set():
            self._delivered.wait(self._wait)
        if self._server is not None:
            self._server.shutdown()
            self._server.server_close()
            self._server = None

    def follow(self) -> queue.Queue[Event | None]:
        """Return the events for the browser that has come."""
        self._arrived.set()
        return self._events

    def left(self) -> None:
        """Note that the browser has all events, or is gone."""
        self._delivered.set()


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, window: BrowserWindow, page: str) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.window, self.page = window, page.encode()


class _Handler(BaseHTTPRequestHandler):
    server: _Server

    def do_GET(self) -> None:
        """Answer with the page or with its events."""
        if self.path == "/":
            self._answer("text/html; charset=utf-8", self.server.page)
        elif self.path == "/events":
            self._stream()
        else:
            self.send_error(404)

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing."""

    def _answer(self, kind: str, body: bytes) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def _stream(self) -> None:
        """Send events as they come, until the last one."""
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        events = self.server.window.follow()
        try:
            while (event := events.get()) is not None:
                self.wfile.write(f"data: {json.dumps(event, allow_nan=False)}\n\n".encode())
                self.wfile.flush()
        except OSError:
            pass
        finally:
            self.server.window.left()


def _has_screen() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
