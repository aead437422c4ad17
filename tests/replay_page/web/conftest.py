"""A headless Chromium that opens pages offline."""

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
SWITCHES = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
READY = "() => window.robotraj !== undefined"


class Browser:
    """Opens pages offline and records their warnings, errors and requests."""

    def __init__(self, chromium: Any) -> None:
        self.chromium, self.console, self.requests = chromium, [], []

    def open(self, path: Any, width: int = 1300, height: int = 800, moment: str = "", **options: Any) -> Any:
        """Open a page; ``moment`` is what follows its address, such as ``#t=0.5``."""
        viewport = {"width": width, "height": height}
        context = self.chromium.new_context(offline=True, reduced_motion="reduce", viewport=viewport, **options)
        page = context.new_page()
        page.on("console", lambda m: self.console.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: self.console.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))
        page.goto(path.as_uri() + moment)
        page.wait_for_function(READY, timeout=90_000)
        return page

    def sizes(self, page: Any) -> Iterator[tuple[int, int]]:
        """Give a page the sizes of a desk, a tablet, a phone and a phone that lies, one after the other."""
        for width, height in ((1400, 900), (1024, 768), (390, 844), (844, 390)):
            page.set_viewport_size({"width": width, "height": height})
            page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            yield width, height

    def check(self, path: Any) -> None:
        assert self.console == []
        own = {url.split("#")[0] for url in self.requests if not url.startswith(("data:", "blob:"))}
        assert own == {path.as_uri()}


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    if CHROMIUM is None:
        pytest.skip("no chromium, chromium-browser or google-chrome on the PATH")
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=CHROMIUM, args=SWITCHES)
        yield started
        started.close()


@pytest.fixture
def browser(chromium: Any) -> Iterator[Browser]:
    opened = Browser(chromium)
    yield opened
    for context in chromium.contexts:
        context.close()
