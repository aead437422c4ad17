"""The tools of the site: links between files become links between pages, and a broken one is found."""

from __future__ import annotations

import inspect
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import robotraj as rt

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "docs"), str(ROOT / "docs" / "_extensions")]

import check_links  # noqa: E402
import check_search  # noqa: E402
import mirror  # noqa: E402

PAGE = ROOT / "docs" / "how-to" / "arms.md"


@pytest.mark.parametrize(
    ("link", "leads"),
    [
        ("obstacles.md", "obstacles.md"),
        ("../conventions.md#effort", "../conventions.md#effort"),
        ("#goals", "#goals"),
        ("https://example.org/a.md", "https://example.org/a.md"),
        ("../../examples/05_ur5.py", "../generated/examples/05_ur5.md"),
        ("../../benchmarks/cases.md", "../generated/benchmarks/cases.md"),
        ("../../CONTRIBUTING.md#a-constraint", "../generated/contributing.md#a-constraint"),
        ("../../LICENSE", f"{mirror.FORGE}/blob/main/LICENSE"),
        ("../../robots", f"{mirror.FORGE}/tree/main/robots"),
    ],
)
def test_a_link_leads_to_the_page_of_its_file(link: str, leads: str) -> None:
    assert mirror.moved(link, PAGE, PAGE, mirror.copies()) == leads


def test_links_in_code_are_no_links() -> None:
    text = "[a](../../LICENSE)\n\n```text\n[a](../../LICENSE)\n```\n"
    changed = mirror.rewritten(text, PAGE, PAGE, mirror.copies())
    assert changed.count("](../../LICENSE)") == 1 and changed.startswith(f"[a]({mirror.FORGE}")


def test_broken_links_missing_anchors_and_files_from_elsewhere_are_found(tmp_path: Path) -> None:
    (tmp_path / "good.html").write_text('<h1 id="top">A</h1><a href="#top">up</a><a href="https://example.org">x</a>')
    assert check_links.faults(tmp_path) == []
    (tmp_path / "bad.html").write_text(
        '<a href="none.html">1</a><a href="good.html#none">2</a><script src="https://example.org/a.js"></script>'
    )
    faults = check_links.faults(tmp_path)
    assert len(faults) == 3
    assert check_links.faults(tmp_path / "nothing") == [f"{tmp_path / 'nothing'} has no page"]
    assert "does not exist" in faults[0] and "no such anchor" in faults[1] and "loads https" in faults[2]


def test_the_gallery_is_small() -> None:
    pictures = (ROOT / "docs" / "_static" / "gallery").iterdir()
    assert sum(picture.stat().st_size for picture in pictures) < 10e6


def test_the_gallery_has_forty_tiles_with_code_and_picture() -> None:
    tiles = json.loads((ROOT / "docs" / "gallery" / "results.json").read_text())["tiles"]
    assert len(tiles) >= 40
    failing = {tile["file"] for tile in tiles if "fail" in tile["verdict"] or "missed" in tile["verdict"]}
    assert failing <= {"13_hopper"}, "its impacts last one interval, so that no simulation repeats them"
    for tile in tiles:
        assert (ROOT / tile["code"]).exists()
        assert (ROOT / "docs" / "_static" / "gallery" / f"{tile['file']}.webp").exists(), tile["file"]
        if tile["moment"] is not None:
            assert (ROOT / "docs" / "_static" / "gallery" / f"{tile['file']}_moving.webp").exists(), tile["file"]
        assert tile["kind"] == "example" or tile["replays"]
        assert tile["verdict"] and tile["seconds"] > 0.0 and tile["commit"]


def public_values() -> Iterator[tuple[str, object]]:
    """Yield every public name with its value, and the methods of classes."""
    for space in (rt, *(value for value in vars(rt).values() if isinstance(value, ModuleType))):
        for name in getattr(space, "__all__", ()):
            value = getattr(space, name)
            yield name, value
            if isinstance(value, type):
                yield from ((f"{name}.{key}", entry) for key, entry in vars(value).items() if key[0] != "_")


def test_nothing_but_entries_stands_in_the_sections_of_a_docstring() -> None:
    """NumPy's sections go on to the next heading: a sentence after the parameters would become one of them."""
    for name, value in public_values():
        section = ""
        lines = (inspect.getdoc(value) or "").splitlines()
        for line, below in zip(lines, [*lines, ""][1:], strict=True):
            if below and not below.strip("-"):
                section = line
            elif section in ("Parameters", "Attributes") and line[:1] not in ("", " ", "-"):
                assert " : " in line or len(line.split()) <= 6, f"{name}: {line}"


def test_the_glossary_knows_the_words_that_users_type() -> None:
    terms = check_search.terms((ROOT / "docs" / "glossary.md").read_text())
    assert len(terms) >= 60
    asked = (
        "ros2_control", "safe", "cluster", "slurm", "suction", "gripper", "rail", "elbow up", "payload", "cobot",
        "emergency stop", "limit tool speed", "no effort limits", "not proved", "stop waypoint", "ROS 2", "collision",
    )  # fmt: skip
    assert set(asked) <= set(terms)
    assert all((ROOT / "docs" / f"{page}.md").is_file() for page in terms.values())


def test_a_query_that_finds_another_page_first_is_a_fault() -> None:
    wanted = {"rail": "how-to/rail", "walk": "how-to/gaits", "slurm": "how-to/cluster", "lift": "how-to/rail"}
    found = {"rail": "glossary#term-rail", "walk": "how-to/gaits", "slurm": "how-to/arms#goals", "lift": ""}
    wrong = check_search.faults(wanted, found)
    assert len(wrong) == 2 and "'slurm' finds how-to/arms#goals first, not how-to/cluster" in wrong[0]
    assert "'lift' finds nothing first" in wrong[1]
