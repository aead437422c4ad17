"""The schema describes the classes: the documentation shows it, and it contains every class of a problem."""

from __future__ import annotations

import pytest

import robotraj as rt
from robotraj.applications.problem_files.kinds import GAITS, KINDS, WRITTEN_OTHERWISE
from robotraj.applications.problem_files.schema import entries, entry_named, reference
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.objectives.base import EndCost, Integral


def test_every_table_and_type_stands_in_the_reference() -> None:
    written = reference()
    for group in entries().values():
        for entry in group:
            assert f"**`{entry.name}`**" in written
    assert "| `height` |" in written and "| `payload` | CarriedBody" in written


@pytest.mark.parametrize("namespace", [rt.constraints, rt.objectives, rt.links, rt.contacts, rt.obstacles, rt.schemes])
def test_public_classes_of_a_problem_may_be_named(namespace: object) -> None:
    bases = {
        "Constraint",
        "Objective",
        "Integral",
        "EndCost",
        "Link",
        "Contact",
        "Obstacle",
        "Scheme",
        "Control",
        "Sole",
    }
    for name in namespace.__all__:  # type: ignore[attr-defined]
        kind = getattr(namespace, name)
        if isinstance(kind, type) and bases & {base.__name__ for base in kind.__mro__[1:]} and name not in bases:
            abstract = bool(getattr(kind, "__abstractmethods__", ())) or name in (
                "Collocation",
                "Shooting",
                "OneStep",
                "Sum",
            )
            assert abstract or name in KINDS or name in WRITTEN_OTHERWISE, name


def test_every_function_that_writes_a_gait_may_be_named() -> None:
    moving = {"walk", "run", "trot", "crawl", "turn", "sidestep", "stairs", "gap", "start_stop", "steps", "heel_to_toe"}
    assert moving | {"jump", "flip"} == set(GAITS)


def test_an_entry_lists_keys_kinds_and_defaults() -> None:
    rows = {key: (takes, default) for key, takes, default in entry_named("GroundClearance").rows()}
    assert rows["height"][1] == "0.0" and rows["frames"][1] == "required"
    assert ("mesh", "Mesh, a list of Mesh or 'none'", "none") in entry_named("plan").rows()
    assert entry_named("[[phases]]").name == "[[phases]]"
    with pytest.raises(rt.UnknownName, match="Did you mean 'Effort'"):
        entry_named("Efort")


def test_objectives_and_constraints_have_summaries() -> None:
    groups = entries()
    assert all(entry.summary for group in groups.values() for entry in group)
    for title, base in (("Objectives", (Integral, EndCost)), ("Constraints", (Constraint,))):
        names = {entry.name for entry in groups[title]}
        assert sum(issubclass(KINDS[name], base) for name in names if isinstance(KINDS[name], type)) > 10
