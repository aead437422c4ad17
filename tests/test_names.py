"""Every name of robotraj that an example, a benchmark or a code block of the documents uses exists."""

from __future__ import annotations

import ast
import re
from operator import attrgetter
from pathlib import Path

import pytest

import robotraj as rt

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SCRIPTS = [*sorted((ROOT / "examples").glob("*.py")), *sorted((ROOT / "benchmarks").rglob("*.py"))]
PAGES = [path for path in sorted((ROOT / "docs").rglob("*.md")) if ROOT / "docs" / "generated" not in path.parents]
DOCUMENTS = [*sorted(ROOT.glob("*.md")), *PAGES, *sorted((ROOT / "robots").glob("*.md"))]


def names(code: str) -> set[str]:
    """Dotted names that begin with ``rt.``: rt.schemes.LobattoIIIA, not rt.schemes alone."""
    inner, found = set(), set()
    for node in ast.walk(ast.parse(code)):
        parts, at = [], node
        while isinstance(at, ast.Attribute):
            parts.append(at.attr)
            at = at.value
        if parts and isinstance(at, ast.Name) and at.id == "rt":
            found.add(".".join(reversed(parts)))
            inner.add(".".join(reversed(parts[1:])))
    return found - inner


def check(code: str) -> None:
    for name in sorted(names(code)):
        found: object = rt
        for part in name.split("."):
            assert hasattr(found, part), f"rt.{name} does not exist"
            found = getattr(found, part)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_names_in_scripts_exist(script: Path) -> None:
    check(script.read_text())


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_names_in_code_blocks_exist(document: Path) -> None:
    for block in BLOCK.findall(document.read_text()):
        check(block)


def test_a_missing_name_is_found() -> None:
    with pytest.raises(AssertionError, match=r"rt\.schemes\.Simpson does not exist"):
        check("import robotraj as rt\nrt.plan(rt.Mesh(4, rt.schemes.Simpson()))")


def test_names_that_the_benchmarks_pass_as_text_exist(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "peers"))
    import tools

    keys = ("PEERS_SOLVER", "PEERS_ENGINE", "PEERS_INTERVAL_LIMITS")
    own = [tool for tool in tools.TOOLS.values() if tool.script == "plan_robotraj.py"]
    given = {tool.variables[key] for tool in own for key in keys if key in tool.variables}
    assert {"InteriorPoint", "engines.Native"} <= given
    for name in given:
        attrgetter(name)(rt)
