"""Small pictures of the tiles: the robot in the middle of its replay and along it, or the curves that were drawn."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "docs" / "_static" / "gallery"
WIDTH, HEIGHT = 360, 288  # [px]
FRAMES = 20
"""Pictures of an animation."""
PERIOD = (1.5, 4.0)
"""Least and greatest time in which an animation shows the whole motion [s]."""

sys.path.insert(0, str(ROOT / "examples" / "images"))
from pictures import SIZE, open_view, take  # noqa: E402


def fitted(picture: Path) -> Image.Image:
    """Return a picture in the size of a tile."""
    image = Image.open(picture).convert("RGB")
    image.thumbnail((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    tile = Image.new("RGB", (WIDTH, HEIGHT), "white")
    tile.paste(image, ((WIDTH - image.width) // 2, (HEIGHT - image.height) // 2))
    return tile


def film(page: Page, folder: Path, file: str) -> None:
    """Keep the motion of an open replay as an animated WebP."""
    end = page.evaluate("window.robotraj.player.end")
    images = []
    for number in range(FRAMES):
        picture = folder / f"{file}_frame.png"
        take(page, end * number / (FRAMES - 1), picture, pause=150.0)
        images.append(fitted(picture))
    picture.unlink()
    step = 1e3 * min(max(end, PERIOD[0]), PERIOD[1]) / FRAMES  # [ms]
    steps = [round(step)] * (FRAMES - 1) + [900]
    options = {"quality": 45, "method": 6, "duration": steps, "loop": 0, "minimize_size": True}
    images[0].save(OUT / f"{file}_moving.webp", save_all=True, append_images=images[1:], **options)


def draw(tiles: list[dict[str, Any]], folder: Path) -> None:
    """Make the pictures of every tile: from its replay where a moment of it is known, else from a figure."""
    OUT.mkdir(parents=True, exist_ok=True)
    options = ["--use-gl=angle", "--use-angle=swiftshader", "--no-sandbox"]
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=options)
        page = browser.new_page(viewport=SIZE, reduced_motion="reduce")
        for tile in tiles:
            figure = folder / f"{tile['file']}.png"
            if tile["moment"] is not None:
                figure = folder / f"{tile['file']}_view.png"
                open_view(page, folder / tile["replays"][0])
                take(page, tile["moment"], figure)
                film(page, folder, tile["file"])
            if figure.exists():
                fitted(figure).save(OUT / f"{tile['file']}.webp", quality=70, method=6)
        browser.close()
