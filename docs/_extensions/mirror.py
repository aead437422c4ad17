"""Pages that stand elsewhere in the repository, and links that lead there.

Examples, benchmark tables, CONTRIBUTING, CHANGELOG and the list of robots are copied to ``docs/generated`` when the
site is built, so nothing is typed twice. Markdown files link each other by their places in the repository, as a forge
needs it. Here such a link becomes the copy's place on the site, or the forge's address where the site has no copy.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

DOCS = Path(__file__).resolve().parents[1]
ROOT = DOCS.parent
GENERATED = DOCS / "generated"
FORGE = "https://github.com/robotraj/robotraj"
FENCE = re.compile(r"^(`{3,})[^\n`]*\n.*?^\1$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?<=\]\()([^)\s]+)(?=\))")


def copies() -> dict[Path, Path]:
    """Return the copy's place by the place of each file of the repository that the site shows."""
    found = {ROOT / name: GENERATED / name.lower() for name in ("CONTRIBUTING.md", "CHANGELOG.md")}
    found[ROOT / "robots" / "README.md"] = GENERATED / "robots.md"
    for table in (ROOT / "benchmarks").rglob("*.md"):
        found[table] = GENERATED / table.relative_to(ROOT)
    for example in (ROOT / "examples").glob("[0-9]*.py"):
        found[example] = GENERATED / "examples" / f"{example.stem}.md"
    return found


def moved(link: str, source: Path, page: Path, places: dict[Path, Path]) -> str:
    """Return where a link of ``source`` leads when its text stands in ``page``."""
    path, mark, anchor = link.partition("#")
    if not path or re.match(r"[a-z]+:", link):
        return link
    target = (source.parent / path).resolve()
    if target not in places and DOCS not in target.parents and target.suffix not in (".png", ".svg"):
        kind = "tree" if target.is_dir() else "blob"
        return f"{FORGE}/{kind}/main/{target.relative_to(ROOT)}{mark}{anchor}"
    return os.path.relpath(places.get(target, target), page.parent) + mark + anchor


def rewritten(text: str, source: Path, page: Path, places: dict[Path, Path]) -> str:
    """Return a Markdown text with its links moved, code blocks untouched."""
    parts, end = [], 0
    for block in FENCE.finditer(text):
        parts += [LINK.sub(lambda link: moved(link[1], source, page, places), text[end : block.start()]), block[0]]
        end = block.end()
    return "".join(parts) + LINK.sub(lambda link: moved(link[1], source, page, places), text[end:])


def write(path: Path, text: str) -> None:
    """Write a file unless it has this text already: Sphinx reads again what is newer."""
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def mirror(app: Sphinx, config: Config) -> None:
    """Write the copies of Markdown files; ``tiles`` writes the pages of examples."""
    places = copies()
    for source, page in places.items():
        if source.suffix == ".md":
            text = rewritten(source.read_text(), source, page, places)
            # A bare table has the name of its file for a title.
            title = "" if text.lstrip().startswith("# ") else f"# {source.stem.replace('_', ' ').capitalize()}\n\n"
            write(page, title + text)


def read(app: Sphinx, name: str, content: list[str]) -> None:
    """Move the links of a page of the site."""
    page = DOCS / f"{name}.md"
    if page.exists() and GENERATED not in page.parents:
        content[0] = rewritten(content[0], page, page, copies())


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the copies first, before pages are looked for."""
    app.connect("config-inited", mirror, priority=100)
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
