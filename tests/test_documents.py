"""Every Python block of README, CONTRIBUTING and docs/ runs; every relative link has a target."""

from __future__ import annotations

import codeop
import re
import subprocess
import sys
from pathlib import Path

import pytest

import robotraj as rt

ROOT = Path(__file__).parents[1]
PAGES = [path for path in sorted((ROOT / "docs").rglob("*.md")) if ROOT / "docs" / "generated" not in path.parents]
DOCUMENTS = [*sorted(ROOT.glob("*.md")), *PAGES]
FENCE = re.compile(r"^(?:```|~~~)([^\n`]*)\n(.*?)^(?:```|~~~)$", re.MULTILINE | re.DOTALL)
SLOW = "<!-- slow -->"
"""Stands on the first lines of a document whose blocks take more than about 5 s."""


def place(path: Path) -> str:
    """Name a document by its place in the repository."""
    return str(path.relative_to(ROOT).with_suffix(""))


def blocks_of(text: str, language: str) -> list[str]:
    """Blocks of a document in one language."""
    return [match[2] for match in FENCE.finditer(text) if match[1] == language]


def python_blocks(text: str) -> list[tuple[int, str]]:
    """Python blocks of a document with the line on which each begins."""
    blocks = [(match.start(2), match[2]) for match in FENCE.finditer(text) if match[1] == "python"]
    return [(text.count("\n", 0, start), code) for start, code in blocks]


def anchors(text: str) -> set[str]:
    """Anchors that a forge makes of the headings."""
    titles = re.findall(r"^#+ (.*)$", FENCE.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


WITH_CODE = [
    pytest.param(path, id=place(path), marks=[pytest.mark.slow] if SLOW in path.read_text() else [])
    for path in DOCUMENTS
    if python_blocks(path.read_text())
]


@pytest.mark.parametrize("document", WITH_CODE)
def test_the_blocks_of_a_document_run_in_turn(document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    for line, code in python_blocks(document.read_text()):
        # The blank lines make a traceback show the document's own line.
        exec(compile("\n" * line + code, str(document), "exec"), names)
    figures = re.findall(r"\]\(figures/([\w.]+)\)", document.read_text())
    assert {path.name for path in tmp_path.glob("*.svg")} >= set(figures), "a figure is not drawn by its page"


@pytest.mark.parametrize("document", [ROOT / "README.md", *PAGES], ids=place)
def test_the_blocks_can_be_pasted_into_an_interactive_session(document: Path) -> None:
    """There a blank line ends an indented block, and nothing else does."""
    for line, code in python_blocks(document.read_text()):
        pending: list[str] = []
        for number, text in enumerate(code.splitlines(), line + 1):
            pending.append(text)
            try:
                if codeop.compile_command("\n".join(pending), symbol="single"):
                    pending = []
            except SyntaxError:
                pytest.fail(f"{document.name}, line {number}: {text!r} needs a blank line before it")


@pytest.mark.slow
def test_the_problem_file_of_its_page_is_planned_and_its_commands_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "problem-files.md").read_text()
    (file,) = blocks_of(text, "toml")
    Path("page.toml").write_text(file)
    assert rt.load_problem("page.toml").plan().success
    (commands,) = blocks_of(text, "sh")
    lines = [line.split("#")[0].split() for line in commands.splitlines()]
    assert all(line[0] == "robotraj" for line in lines)
    for line in lines:
        subprocess.run([sys.executable, "-m", *line], check=True, stdout=subprocess.DEVNULL)
    (message,) = blocks_of(text, "text")
    Path("problem.toml").write_text(file.replace('"tool0"', '"tool1"'))
    with pytest.raises(rt.InputError, match=f"^{re.escape(message.strip())}"):
        rt.load_problem("problem.toml")


def test_the_first_plan_of_a_newcomer_is_proved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for _, code in python_blocks((ROOT / "README.md").read_text()):
        exec(code, names)
    assert rt.validate(names["solution"]).passed  # type: ignore[arg-type]
    assert list(tmp_path.glob("*.html"))


@pytest.mark.parametrize("document", DOCUMENTS, ids=place)
def test_relative_links_lead_somewhere(document: Path) -> None:
    text = FENCE.sub("", document.read_text())
    for target in re.findall(r"""(?:\]\(|href="|src=")([^)"\s]+)[)"]""", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        if "generated/" in path:
            continue  # written when the site is built, whose links docs/check_links.py follows
        file = (document.parent / path).resolve() if path else document
        assert file.exists(), f"{document.name} links to {target}, which does not exist"
        if anchor and file.suffix == ".md":
            assert anchor in anchors(file.read_text()), f"{document.name} links to {target}: no such heading"


@pytest.mark.parametrize("document", [path for path in DOCUMENTS if path.stem != "CHANGELOG"], ids=place)
def test_names_in_the_text_exist(document: Path) -> None:
    text = FENCE.sub("", document.read_text())
    for name in re.findall(r"\brt((?:\.[A-Za-z]\w*)+)", " ".join(re.findall(r"`([^`]+)`", text))):
        found: object = rt
        for part in name[1:].split("."):
            assert hasattr(found, part), f"{document.name} names rt{name}, which does not exist"
            found = getattr(found, part)


def test_the_front_page_is_short() -> None:
    """At most 900 words, pictures, tables and code included."""
    assert len((ROOT / "README.md").read_text().split()) <= 900


def test_the_times_on_the_front_page_are_those_of_the_benchmark(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks" / "peers"))
    import front

    table = front.front(front.RESULTS.read_text())
    assert len(re.findall(r"\| [\d.]+\*?(?= \|)", table)) == 8
    assert f"<!-- peers:begin -->\n{table}<!-- peers:end -->" in front.README.read_text()
