"""Pages of the built site at four widths: none scrolls sideways. ``python docs/check_widths.py build/site``.

Replays are pages like the others. Their charts follow the window one frame later, so a width is read after a frame.
"""

from __future__ import annotations

import sys
from pathlib import Path

from check_search import opened

SIZES = (1400, 900), (820, 1180), (844, 390), (390, 844)
"""Widths and heights of a screen, a tablet, and a phone in both positions."""

BEYOND = """() => new Promise(done => requestAnimationFrame(() => {
  const page = document.documentElement;
  done(page.scrollWidth - page.clientWidth);
}))"""


def faults(site: Path) -> list[str]:
    """Return one line for each page and width at which the page is wider than the window."""
    pages = [path.relative_to(site).as_posix() for path in sorted(site.rglob("*.html"))]
    wide = []
    with opened(site) as (page, address):
        for name in pages:
            page.goto(f"{address}/{name}", wait_until="domcontentloaded")
            for width, height in SIZES:
                page.set_viewport_size({"width": width, "height": height})
                beyond = page.evaluate(BEYOND)
                if beyond > 0:
                    wide.append(f"{name} scrolls by {beyond} px at a width of {width} px")
    return wide


if __name__ == "__main__":
    wrong = faults(Path(sys.argv[1]).resolve())
    print("\n".join(wrong) or "no page scrolls sideways")
    sys.exit(1 if wrong else 0)
