"""The window of a watched plan: a page and its events over a local socket, with no thread or socket left open."""

import http.client
import json
import os
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from robotraj.replay_page.live import event_log
from robotraj.replay_page.live.live_window import BrowserWindow
from robotraj.replay_page.live.page_server import MOST_LISTENERS, MOST_REQUESTS, PATIENCE


def test_a_browser_gets_the_page_and_every_event_in_order() -> None:
    window = BrowserWindow(show=False, wait=20.0)
    window.open("<title>live</title>")
    for number in range(3):
        window.send({"number": number})
    assert urllib.request.urlopen(window.address, timeout=20).read() == b"<title>live</title>"
    stream = urllib.request.urlopen(window.address + "events", timeout=20)
    assert stream.headers["Content-Type"] == "text/event-stream"
    window.send({"number": 3})
    closing = threading.Thread(target=window.close)
    closing.start()
    lines = [line for line in stream.read().decode().split("\n\n") if line]
    closing.join(20.0)
    assert [json.loads(line.removeprefix("data: ")) for line in lines] == [{"number": k} for k in range(4)]
    assert not closing.is_alive()
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(window.address, timeout=5)


@pytest.fixture
def window() -> Iterator[BrowserWindow]:
    made = BrowserWindow(show=False, wait=0.5)
    made.open("page")
    yield made
    made.close()


def status(window: BrowserWindow, path: str, **headers: str) -> int:
    """Status of a request; ``{secret}`` stands for the path of the address."""
    address = urlsplit(window.address)
    connection = http.client.HTTPConnection(str(address.hostname), address.port, timeout=20)
    connection.request("GET", path.format(secret=address.path), headers=headers)
    return connection.getresponse().status


def test_the_address_is_a_secret_and_the_host_is_this_machine(window: BrowserWindow) -> None:
    port = urlsplit(window.address).port
    assert status(window, "{secret}") == status(window, "{secret}", Host=f"localhost:{port}") == 200
    assert status(window, "{secret}", Origin=f"http://127.0.0.1:{port}") == 200
    assert status(window, "{secret}../etc/passwd") == status(window, "{secret}?x") == 404
    for path in ("/", "/events", "//", "/favicon.ico", "/x/events"):
        assert status(window, path) == 403
    for headers in ({"Host": "site.example"}, {"Host": f"site.example:{port}"}, {"Origin": "http://site.example"}):
        assert status(window, "{secret}", **headers) == status(window, "{secret}events", **headers) == 403
    assert BrowserWindow(show=False).address == "" != window.address


def test_every_listener_gets_the_events_from_the_start() -> None:
    window = BrowserWindow(show=False, wait=20.0)
    window.open("")
    streams = []
    for number in range(3):
        window.send({"number": number})
        streams.append(urllib.request.urlopen(window.address + "events", timeout=20))
    urllib.request.urlopen(window.address + "events", timeout=20).close()  # a browser that leaves
    closing = threading.Thread(target=window.close)
    closing.start()
    expected = b"".join(b'data: {"number": %d}\n\n' % number for number in range(3))
    assert [stream.read() for stream in streams] == [expected] * 3
    closing.join(20.0)
    assert not closing.is_alive()


def test_half_requests_and_many_listeners_leave_the_page_to_others(window: BrowserWindow) -> None:
    before = threading.active_count()
    address = urlsplit(window.address)
    half = []
    for _ in range(200):
        half.append(socket.create_connection((str(address.hostname), address.port), timeout=5))
        half[-1].send(b"GET / HT")
    assert status(window, "{secret}") == 200
    end = time.monotonic() + PATIENCE - 1.0  # before waiting requests end by themselves; threads end when they run
    while threading.active_count() - before > MOST_REQUESTS + 5 and time.monotonic() < end:
        time.sleep(0.05)
    assert threading.active_count() - before <= MOST_REQUESTS + 5
    for each in half:
        each.close()
    window.send({"number": 0})
    listeners = [urllib.request.urlopen(window.address + "events", timeout=20) for _ in range(MOST_LISTENERS)]
    assert status(window, "{secret}events") == 503 and status(window, "{secret}") == 200
    for each in listeners:
        each.close()


def test_the_log_is_bounded_and_keeps_the_first_event(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(event_log, "MOST_BYTES", 30)
    log = event_log.EventLog()
    for number in range(20):
        log.add(b"%02d 5678" % number)
    log.end(0.0)
    with log.listening() as events:
        assert list(events) == [b"00 5678", b"17 5678", b"18 5678", b"19 5678"]


def test_closing_without_a_browser_waits_for_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    before = threading.active_count()
    window = BrowserWindow(show=True, wait=0.01)
    window.open("")
    window.send({"number": 0})
    window.close()
    assert opened == [window.address]
    assert window.address.startswith("http://127.0.0.1:")
    assert threading.active_count() == before


@pytest.mark.skipif(sys.platform != "linux", reason="xdg-open is a program of Linux")
@pytest.mark.parametrize("path", [":/nonexistent", ".:bin:/nonexistent"])
def test_no_program_of_the_working_folder_opens_the_page(path: str, tmp_path: Path) -> None:
    (tmp_path / "bin").mkdir()
    for planted in (tmp_path / "xdg-open", tmp_path / "bin" / "xdg-open"):
        planted.write_text(f"#!/bin/sh\n/bin/touch {tmp_path}/run\n")
        planted.chmod(0o755)
    environment = {**os.environ, "PATH": path, "DISPLAY": ":0"}
    opening = (
        "from robotraj.replay_page.live.live_window import BrowserWindow;"
        "window = BrowserWindow(True, 0.01); window.open(''); window.close()"
    )
    unguarded = "import webbrowser; webbrowser.open('http://127.0.0.1')"
    for code, is_run in ((opening, False), (unguarded, True)):
        subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environment, check=True, timeout=60)
        # The program outlives the interpreter that started it.
        until = time.monotonic() + 20.0 * is_run
        while not (tmp_path / "run").exists() and time.monotonic() < until:
            time.sleep(0.05)
        assert (tmp_path / "run").exists() is is_run
