"""Write the Python code of README, of every page and of the examples into a folder, where a type checker reads it.

Usage: ``python .ci/documents_code.py FOLDER``. The blocks of a page become one file, since later ones use names of
earlier ones. Pinocchio ships no types: a stub says so.
"""

import re
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def main(folder: Path) -> None:
    """Write one file for each page with code, and one for each example."""
    (folder / "typings" / "pinocchio").mkdir(parents=True)
    stub = "from typing import Any\n\ndef __getattr__(name: str) -> Any: ...\n"
    (folder / "typings" / "pinocchio" / "__init__.pyi").write_text(stub)
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "robots").glob("*.md")]
    for page in sorted(pages):
        blocks = BLOCK.findall(page.read_text())
        if blocks and "generated" not in page.parts:
            name = re.sub(r"\W", "_", str(page.relative_to(ROOT).with_suffix("")))
            (folder / f"{name}.py").write_text("\n".join(blocks))
    for example in sorted((ROOT / "examples").glob("[0-9]*.py")):
        shutil.copy(example, folder / f"example_{example.name}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
