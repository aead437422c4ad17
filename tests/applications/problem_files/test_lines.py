"""Every key and entry of a TOML text has the line on which it stands."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from robotraj.applications.problem_files.lines import KeyPath, line_of, lines_of, named

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

EXAMPLES = sorted((Path(__file__).parents[3] / "examples").glob("*.toml"))

TEXT = '''# a comment with [brackets] = "x"
a = 1
b.c = [1,
  2, # x ]
  {d = "}", e=[3,
  4]}]
[robot]
source = "u\\"r5"   # hello
"quoted key" = """
x = 3
["""
'single' = \'\'\'
]\'\'\'
[[phases]]
name = 'x'
start.q = [0]
[phases.end]
q = 1
[[phases]]
[[phases.constraints]]
type = "A"
[[phases.constraints]]
type = "B"
z = inf
'''

LINES = {
    ("a",): 2,
    ("b", "c", 1): 4,
    ("b", "c", 2, "e", 1): 6,
    ("robot", "source"): 8,
    ("robot", "quoted key"): 9,
    ("robot", "single"): 12,
    ("phases", 0): 14,
    ("phases", 0, "start", "q", 0): 16,
    ("phases", 0, "end", "q"): 18,
    ("phases", 1): 19,
    ("phases", 1, "constraints", 1, "z"): 24,
}


def places(data: object, place: KeyPath = ()) -> list[KeyPath]:
    pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [found for key, value in pairs for found in ((*place, key), *places(value, (*place, key)))]


@pytest.mark.parametrize(("place", "line"), LINES.items(), ids=[named(place) for place in LINES])
def test_the_line_of_a_key(place: KeyPath, line: int) -> None:
    assert lines_of(TEXT)[place] == line


@pytest.mark.parametrize(
    "text", [TEXT, *(path.read_text() for path in EXAMPLES)], ids=["text", *(p.stem for p in EXAMPLES)]
)
def test_every_value_that_is_read_has_a_line_and_no_other(text: str) -> None:
    assert set(lines_of(text)) == set(places(tomllib.loads(text)))


def test_a_missing_key_has_the_line_of_its_table() -> None:
    assert line_of(("phases", 0, "duration"), lines_of(TEXT)) == 14
    assert line_of(("nowhere",), lines_of(TEXT)) is None


def test_places_are_written_as_in_python() -> None:
    assert named(("phases", 0, "end", "q", 2)) == "phases[0].end.q[2]"
