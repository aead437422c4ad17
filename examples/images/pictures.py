"""Take the pictures of README's gallery from the replays that the examples write.

Run the examples in an empty folder first, then: python pictures.py FOLDER [PICTURE ...]
Needs playwright (extra ``test``) and a Chromium in the path.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

PICTURES = {
    "cartpole": ("03_cartpole.html", 1.1),
    "ur5": ("05_ur5.html", 0.45),
    "five_link": ("11_five_link_0.1.html", 2.5),
    "solo12": ("14_solo12_trot.html", 0.35),
    "talos": ("15_talos_legs_walking.html", 1.1),
    "stairs": ("16_stairs.html", 1.0),
}
"""Picture, its replay, and the moment [s] that it shows."""

SIZE = {"width": 1180, "height": 620}
QUIET = "header, footer, #marks, #legend, #follow, #home, .legend { visibility: hidden !important }"


def open_view(page: Page, replay: Path) -> None:
    """Open a replay and show the robot alone, without labels and buttons."""
    page.goto(replay.as_uri())
    page.wait_for_function("() => window.robotraj && document.querySelector('#pane canvas')")
    page.wait_for_timeout(3000)
    page.add_style_tag(content=QUIET)


def take(page: Page, moment: float, picture: Path, pause: float = 1500.0) -> None:
    """Save the view of an open replay at one moment [s], after a pause [ms] in which it is drawn."""
    page.evaluate("t => window.robotraj.seek(t)", moment)
    page.wait_for_timeout(pause)
    box = page.locator("#pane canvas").first.bounding_box()
    size = {"width": min(600, box["width"]), "height": min(480, box["height"])}
    page.screenshot(path=picture, clip={"x": box["x"], "y": box["y"]} | size)


def main(folder: Path, wanted: list[str]) -> None:
    """Take the pictures that are wanted, all by default."""
    options = ["--use-gl=angle", "--use-angle=swiftshader", "--no-sandbox"]
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=options)
        page = browser.new_page(viewport=SIZE, reduced_motion="reduce")
        for name in wanted or PICTURES:
            replay, moment = PICTURES[name]
            picture = Path(__file__).parent / f"{name}.png"
            open_view(page, (folder / replay).resolve())
            take(page, moment, picture)
            print(f"wrote {picture.name}, {picture.stat().st_size / 1e3:.0f} kB")
        browser.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
