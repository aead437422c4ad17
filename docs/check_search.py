"""The search of the built site: what users type finds its page first. ``python docs/check_search.py build/site``."""

from __future__ import annotations

import contextlib
import functools
import http.server
import re
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

GLOSSARY = "glossary"
ENTRY = re.compile(r"\]\(([\w/.-]+)\.md(?:#[\w-]+)?\)")

OTHER = {
    "walk": "how-to/gaits",
    "gaits": "how-to/gaits",
    "problem files": "problem-files",
    "your own urdf": "how-to/own-robot",
    "keep the elbow up": "how-to/elbow-and-stops",
    "three points with a stop": "how-to/elbow-and-stops",
    "rail under an arm": "how-to/rail",
}
"""Queries beside the terms of the glossary, with the page that answers them."""


def terms(text: str) -> dict[str, str]:
    """Return the terms of the glossary, each with the page that its line links to."""
    found: dict[str, str] = {}
    waiting: list[str] = []
    for line in text.partition(":::{glossary}\n")[2].partition(":::")[0].splitlines():
        if line.startswith("  "):
            if page := ENTRY.search(line):
                found |= {term: page[1] for term in waiting}
                waiting = []
        elif line:
            waiting.append(line)
    return found


@contextlib.contextmanager
def opened(site: Path) -> Iterator[tuple[Any, str]]:
    """Serve a site; yield a page of a browser without a window, and the address of the site."""
    from playwright.sync_api import sync_playwright

    handler = functools.partial(Quiet, directory=str(site))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with sync_playwright() as tool:
            browser = tool.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
            yield browser.new_page(), f"http://127.0.0.1:{server.server_port}"
            browser.close()
    finally:
        server.shutdown()


def answers(site: Path, queries: list[str]) -> dict[str, str]:
    """Return the page of the first hit of each query, with its anchor; empty where nothing was found."""
    with opened(site) as (page, address):
        page.goto(f"{address}/search.html?q=robot")
        page.wait_for_function("Search.hasIndex() && document.querySelector('#search-results li')", timeout=60_000)
        # Results are sorted with the best one last.
        first = "q => { const r = Search._performSearch(...Search._parseQuery(q)).pop(); return r ? r[0] + r[2] : '' }"
        return {query: str(page.evaluate(first, query)) for query in queries}


class Quiet(http.server.SimpleHTTPRequestHandler):
    """Serves files without a log."""

    def log_message(self, *_: object) -> None:
        """Print nothing."""


def faults(wanted: dict[str, str], found: dict[str, str]) -> list[str]:
    """Return one line for each query whose first hit is neither its page nor its line in the glossary."""
    wrong = []
    for query, page in wanted.items():
        hit, _, anchor = found[query].partition("#")
        if hit != page and not (hit == GLOSSARY and anchor.startswith("term-")):
            wrong.append(f"{query!r} finds {found[query] or 'nothing'} first, not {page}")
    return wrong


if __name__ == "__main__":
    wanted = terms((Path(__file__).parent / f"{GLOSSARY}.md").read_text()) | OTHER
    wrong = faults(wanted, answers(Path(sys.argv[1]).resolve(), list(wanted)))
    print("\n".join(wrong) or f"{len(wanted)} queries find their page first")
    sys.exit(1 if wrong else 0)
