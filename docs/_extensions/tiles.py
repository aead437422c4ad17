"""The gallery: a grid of tiles, and one page for every example and every case with a published optimum.

``docs/gallery/make.py`` plans them all and writes ``results.json`` and the pictures. Replays are many megabytes; they
are copied to the site where ``build/gallery`` has them.
"""

from __future__ import annotations

import ast
import html
import json
import os
import re
from pathlib import Path
from typing import Any

from mirror import DOCS, FORGE, GENERATED, ROOT, write
from sphinx.application import Sphinx
from sphinx.config import Config

RESULTS = DOCS / "gallery" / "results.json"
PICTURES = DOCS / "_static" / "gallery"
REPLAYS = ROOT / "build" / "gallery"
Tile = dict[str, Any]


def results() -> list[Tile]:
    """Return what ``make.py`` measured, example after example, then case after case."""
    return json.loads(RESULTS.read_text())["tiles"] if RESULTS.exists() else []


def page_of(tile: Tile) -> str:
    """Return the name of a tile's page, from the root of the site."""
    return f"generated/{tile['kind']}s/{tile['file']}"


def shown(value: float | None, digits: int = 6) -> str:
    """Write a number."""
    return "" if value is None else f"{value:.{digits}g}"


def facts(tile: Tile) -> list[tuple[str, str]]:
    """Return what is known of a tile, by its heading."""
    rows = [("objective", shown(tile["objective"], 9))]
    if tile["kind"] == "case":
        known = f", known to {tile['accuracy']:.0e}" if tile["accuracy"] else ", a closed form"
        rows += [("published", shown(tile["published"], 9) + known), ("relative error", f"{tile['error']:.1e}")]
        rows += [("source of the value", tile["source"])]
    return [
        *rows,
        ("processor time to plan", f"{tile['seconds']:.2f} s"),
        ("verdict", tile["verdict"]),
        ("commit", tile["commit"]),
    ]


def replays(tile: Tile) -> list[str]:
    """Return the replays of a tile that were made on this machine."""
    return [name for name in tile["replays"] if (REPLAYS / "replays" / name).exists()]


def picture(tile: Tile, up: str) -> str:
    """Return the picture of a tile as HTML, and the animation over it; empty where there is none."""
    file, moving = f"{tile['file']}.webp", f"{tile['file']}_moving.webp"
    if not (PICTURES / file).exists():
        return ""
    place = f"{up}_static/gallery"
    still = f'<img src="{place}/{file}" alt="{html.escape(tile["title"])}" loading="lazy">'
    # A lazy image that is not displayed is not loaded: the style sheet displays it under the pointer.
    film = f'<img class="film" src="{place}/{moving}" alt="" loading="lazy">' if (PICTURES / moving).exists() else ""
    return still + film


def card(tile: Tile, up: str) -> str:
    """Write a tile of the grid."""
    code = f"{up}{page_of(tile)}.html"
    shows = replays(tile)
    opens = f"{up}replays/{shows[0]}" if shows else code
    links = [("code", code)]
    links += [(f"replay {k}" if len(shows) > 1 else "replay", f"{up}replays/{name}") for k, name in enumerate(shows, 1)]
    values = f"objective {shown(tile['objective'])}"
    if tile["kind"] == "case":
        values += f", published {shown(tile['published'])}"
    lines = [html.escape(tile["title"]), values, f"{tile['seconds']:.2f} s, {html.escape(tile['verdict'])}"]
    lines.append("".join(f'<a href="{target}">{label}</a>' for label, target in links))
    spans = "".join(f"<span>{line}</span>" for line in lines)
    caption = f"<figcaption><b>{html.escape(tile['name'])}</b>{spans}</figcaption>"
    return f'<figure class="tile"><a href="{opens}">{picture(tile, up)}</a>{caption}</figure>'


def grid(tiles: list[Tile]) -> str:
    """Write the tiles as a fragment that a page of ``docs/gallery`` includes."""
    cards = "\n".join(card(tile, "../") for tile in tiles)
    return f'```{{raw}} html\n<div class="tiles">\n{cards}\n</div>\n```\n'


def code_of(tile: Tile, page: Path) -> str:
    """Write the code of a tile: the example, the entry of the table, or the file that builds the case."""
    path, language = ROOT / tile["code"], "yaml" if tile["code"].endswith(".yaml") else "python"
    code = path.read_text()
    if language == "yaml":
        code = next(
            part for part in re.split(r"^(?=- id: )", code, flags=re.M) if part.startswith(f"- id: {tile['name']}\n")
        )
    return f"[{tile['code']}]({FORGE}/blob/main/{tile['code']})\n\n```{language}\n{code.rstrip()}\n```\n"


def page(tile: Tile, place: Path) -> str:
    """Write the page of a tile."""
    rows = "".join(f"| {name} | {value} |\n" for name, value in facts(tile))
    parts = ["---\norphan: true\n---\n", f"# {tile['name']}\n", tile["title"] + "\n"]
    if drawn := picture(tile, "../../"):
        parts.append(f'```{{raw}} html\n<p class="picture">{drawn}</p>\n```\n')
    if shows := replays(tile):
        links = " ".join(f'<a href="../../replays/{name}">{name}</a>' for name in shows)
        parts.append(f"```{{raw}} html\n<p>Replay: {links}</p>\n```\n")
    elif tile["replays"]:
        parts.append(f"`python docs/gallery/make.py {tile['file']}` writes its replay, {', '.join(tile['replays'])}.\n")
    parts.append(f"| | |\n|---|---|\n{rows}")
    parts.append(code_of(tile, place))
    return "\n".join(parts)


def without_results(known: set[str]) -> list[Tile]:
    """Return tiles of examples that were never measured, so that links to them hold."""
    tiles = []
    for example in sorted((ROOT / "examples").glob("[0-9]*.py")):
        if example.stem not in known:
            title = (ast.get_docstring(ast.parse(example.read_text())) or "").splitlines()[0]
            tiles.append({"kind": "example", "name": example.stem, "file": example.stem, "title": title})
    return tiles


def pages(app: Sphinx, config: Config) -> None:
    """Write the grid and the pages of the tiles."""
    tiles = results()
    for kind in ("example", "case"):
        write(GENERATED / f"{kind}s.txt", grid([tile for tile in tiles if tile["kind"] == kind]))
    for tile in tiles:
        place = GENERATED / f"{tile['kind']}s" / f"{tile['file']}.md"
        write(place, page(tile, place))
    for tile in without_results({tile["file"] for tile in tiles}):
        heading = f"---\norphan: true\n---\n\n# {tile['name']}\n\n{tile['title']}\n\n"
        text = heading + code_of(tile | {"code": f"examples/{tile['name']}.py"}, GENERATED)
        write(GENERATED / "examples" / f"{tile['file']}.md", text)
    if REPLAYS.exists():
        config.html_extra_path = [os.path.relpath(REPLAYS, DOCS)]


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them."""
    app.connect("config-inited", pages, priority=150)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
