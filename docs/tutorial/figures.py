"""Draw the figures of the tutorial: run the code of its pages in ``docs/tutorial/figures``, where they save them.

``python docs/tutorial/figures.py [PAGE ...]``. The same code runs in ``tests/test_documents.py``.
"""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path

import matplotlib

HERE = Path(__file__).resolve().parent
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
STYLE = {"svg.hashsalt": "robotraj", "axes.grid": True, "grid.color": "0.92", "font.size": 9, "lines.linewidth": 1.3}
"""The salt makes the same figure the same file."""


def draw(page: Path) -> None:
    """Run the blocks of a page in turn."""
    names: dict[str, object] = {"__name__": "page"}
    for code in BLOCK.findall(page.read_text()):
        exec(compile(code, str(page), "exec"), names)


if __name__ == "__main__":
    os.environ["SOURCE_DATE_EPOCH"] = "0"
    matplotlib.rcParams.update(STYLE)
    os.chdir(HERE / "figures")
    for chosen in sys.argv[1:] or [path.stem for path in sorted(HERE.glob("*.md")) if path.stem != "index"]:
        draw(HERE / f"{chosen}.md")
