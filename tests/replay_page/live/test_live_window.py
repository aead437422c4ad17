"""The window of a watched plan: a page and its events over a local socket, with no thread or socket left open."""

import json
import threading
import urllib.error
import urllib.request
import webbrowser

import pytest

from robotraj.replay_page.live.live_window import BrowserWindow


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


def test_other_addresses_are_refused() -> None:
    window = BrowserWindow(show=False)
    window.open("")
    with pytest.raises(urllib.error.HTTPError, match="404"):
        urllib.request.urlopen(window.address + "../etc/passwd", timeout=20)
    window.close()


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
