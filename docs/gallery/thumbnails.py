"""Small pictures of the tiles: the robot in the middle of its replay, or the curves that were drawn."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "docs" / "_static" / "gallery"
WIDTH, HEIGHT = 360, 288  # [px]

sys.path.insert(0, str(ROOT / "examples" / "images"))
from pictures import SIZE, take  # noqa: E402


def small(picture: Path, file: str) -> None:
    """Fit a picture into a tile and keep it as WebP."""
    image = Image.open(picture).convert("RGB")
    image.thumbnail((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    tile = Image.new("RGB", (WIDTH, HEIGHT), "white")
    tile.paste(image, ((WIDTH - image.width) // 2, (HEIGHT - image.height) // 2))
    tile.save(OUT / f"{file}.webp", quality=70, method=6)


def draw(tiles: list[dict[str, Any]], folder: Path) -> None:
    """Make the picture of every tile: from its replay where a moment of it is known, else from a figure."""
    OUT.mkdir(parents=True, exist_ok=True)
    options = ["--use-gl=angle", "--use-angle=swiftshader", "--no-sandbox"]
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=options)
        page = browser.new_page(viewport=SIZE, reduced_motion="reduce")
        for tile in tiles:
            figure = folder / f"{tile['file']}.png"
            if tile["moment"] is not None:
                figure = folder / f"{tile['file']}_view.png"
                take(page, folder / tile["replays"][0], tile["moment"], figure)
            if figure.exists():
                small(figure, tile["file"])
        browser.close()
