"""Check a built site: every link inside it has a target, and no page loads anything from elsewhere.

``python docs/check_links.py build/site`` lists what is wrong and exits with 1 if anything is.
"""

from __future__ import annotations

import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LINKS = {"a": "href", "img": "src", "script": "src", "link": "href", "iframe": "src", "source": "src"}
"""Elements that link, or that make a browser fetch something, with the attribute that holds the address."""


class Page(HTMLParser):
    """Links and anchors of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[tuple[str, str]] = []
        self.anchors: set[str] = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note an element's name, link and source."""
        given = dict(attrs)
        self.anchors |= {given[name] or "" for name in ("id", "name") if name in given}
        if tag in LINKS and (value := given.get(LINKS[tag])):
            self.links.append((tag, value))


@cache
def page(path: Path) -> Page:
    """Read a page once."""
    return Page(path.read_text())


def faults(site: Path) -> list[str]:
    """Return one line for each link without a target and each file that is loaded from elsewhere.

    A folder without pages is a fault, since nothing was built there.
    """
    pages = sorted(site.rglob("*.html"))
    found = [] if pages else [f"{site} has no page"]
    for path in pages:
        if "replays" in path.relative_to(site).parts[:1]:
            continue  # replays are pages of their own, with tests of their own
        for tag, link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                if tag != "a" and parts.scheme != "data":
                    found.append(f"{path.relative_to(site)} loads {link}")
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                found.append(f"{path.relative_to(site)} links to {link}, which does not exist")
            elif (
                target.suffix == ".html"
                and "replays" not in target.parts
                and unquote(parts.fragment) not in page(target).anchors
            ):
                found.append(f"{path.relative_to(site)} links to {link}: no such anchor")
    return found


if __name__ == "__main__":
    wrong = faults(Path(sys.argv[1]).resolve())
    print("\n".join(wrong) or "every link has a target, and nothing is loaded from elsewhere")
    sys.exit(1 if wrong else 0)
