"""The server of a page for its own user on this machine: a secret address, and bounds of time and connections."""

from __future__ import annotations

import secrets
import socket
import threading
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from robotraj.replay_page.live.event_log import EventLog

PATIENCE = 5.0
"""Longest wait for a request, and for a browser that does not read [s]."""
MOST_REQUESTS = 32
"""Connections whose request is awaited; the oldest one is closed for the next."""
MOST_LISTENERS = 16


class PageServer(ThreadingHTTPServer):
    """Serves a page and its events at 127.0.0.1.

    A request names the secret of the address and this host. Other users of the machine do not know the secret, and
    pages of other sites that resolve to this machine name another host or origin.

    Parameters
    ----------
    page : str
        HTML.
    events : EventLog
    """

    daemon_threads = True
    request_queue_size = 4 * MOST_REQUESTS

    def __init__(self, page: str, events: EventLog) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.page, self.events = page.encode(), events
        self.secret = secrets.token_urlsafe(16)
        port = self.server_address[1]
        self.hosts = (f"127.0.0.1:{port}", f"localhost:{port}")
        self.address = f"http://{self.hosts[0]}/{self.secret}/"
        self.listeners = threading.BoundedSemaphore(MOST_LISTENERS)
        self._lock = threading.Lock()
        self._awaited: dict[socket.socket, None] = {}

    def process_request(self, request: socket.socket, client_address: object) -> None:  # type: ignore[override]
        """Await the request in a thread."""
        with self._lock:
            self._awaited[request] = None
            oldest = next(iter(self._awaited)) if len(self._awaited) > MOST_REQUESTS else None
            if oldest is not None:
                del self._awaited[oldest]
                with suppress(OSError):
                    oldest.shutdown(socket.SHUT_RDWR)
        super().process_request(request, client_address)

    def came(self, request: socket.socket) -> None:
        """Note that the request of a connection has come, or never will."""
        with self._lock:
            self._awaited.pop(request, None)

    def shutdown_request(self, request: socket.socket) -> None:  # type: ignore[override]
        """Close a connection."""
        self.came(request)
        super().shutdown_request(request)

    def handle_error(self, request: object, client_address: object) -> None:
        """Print nothing: connections end as browsers like."""


class _Handler(BaseHTTPRequestHandler):
    server: PageServer
    timeout = PATIENCE

    def do_GET(self) -> None:
        """Answer with the page or with its events."""
        self.server.came(self.connection)
        host, origin = self.headers.get("Host"), self.headers.get("Origin")
        own = host in self.server.hosts and origin in (None, *(f"http://{each}" for each in self.server.hosts))
        start = f"/{self.server.secret}/"
        if not own or not secrets.compare_digest(self.path[: len(start)].encode(), start.encode()):
            self.send_error(403)
        elif self.path == start:
            self._head("text/html; charset=utf-8", len(self.server.page))
            self.wfile.write(self.server.page)
        elif self.path != f"{start}events":
            self.send_error(404)
        elif not self.server.listeners.acquire(blocking=False):
            self.send_error(503)
        else:
            try:
                self._stream()
            finally:
                self.server.listeners.release()

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing."""

    def _head(self, kind: str, length: int | None = None) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")
        self.end_headers()

    def _stream(self) -> None:
        """Send events as they come, until the last one."""
        self._head("text/event-stream")
        with suppress(OSError), self.server.events.listening() as events:
            for event in events:
                self.wfile.write(event)
                self.wfile.flush()
