"""URDFs that are no tree, or too large, are refused by name before Pinocchio reads them."""

from __future__ import annotations

import time

import pytest

import robotraj as rt
from robotraj.robot.urdf.structure import MAX_DEPTH, MAX_LINKS

MASS = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def link(name):
    return f'<link name="{name}">{MASS}</link>'


def joint(name, parent, child, kind="revolute"):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
    )


def robot(*parts):
    return f'<robot name="r">{"".join(parts)}</robot>'


def chain(count, kind="revolute"):
    joints = (joint(f"j{i}", f"l{i}", f"l{i + 1}", kind if i else "revolute") for i in range(count))
    return robot(*map(link, (f"l{i}" for i in range(count + 1))), *joints)


def star(count):
    fixed = (joint(f"j{i}", "l1", f"l{i}", "fixed") for i in range(2, count + 1))
    return robot(*map(link, (f"l{i}" for i in range(count + 1))), joint("j1", "l0", "l1"), *fixed)


BROKEN = {
    "two parents": (
        robot(*map(link, "abc"), joint("one", "a", "c"), joint("two", "b", "c")),
        "link 'c' is the child of joints 'one' and 'two'",
    ),
    "cycle beside the root": (
        robot(*map(link, "abc"), joint("one", "b", "c"), joint("two", "c", "b")),
        "links 'b', 'c' form a cycle",
    ),
    "cycle without a root": (
        robot(*map(link, "ab"), joint("one", "a", "b"), joint("two", "b", "a")),
        "links 'a', 'b' form a cycle",
    ),
    "joint from a link to itself": (robot(link("a"), joint("one", "a", "a")), "link 'a'|links 'a' form a cycle"),
    "link twice": (robot(link("a"), link("b"), link("b"), joint("one", "a", "b")), "links have the name 'b'"),
    "joint twice": (
        robot(*map(link, "abc"), joint("one", "a", "b"), joint("one", "b", "c")),
        "joints have the name 'one'",
    ),
    "link without a name": (robot(link("a"), "<link/>"), "a link has no name"),
    "joint without a name": (robot(*map(link, "ab"), joint("", "a", "b")), "a joint has no name"),
    "joint without a child": (
        robot(link("a"), '<joint name="one" type="fixed"><parent link="a"/></joint>'),
        "child of joint 'one'",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_no_tree_is_refused_by_name(case, urdf):
    text, part = BROKEN[case]
    with pytest.raises(rt.InputError, match=part):
        rt.load(urdf.text(text))


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (chain(20_000), f"20001 links; at most {MAX_LINKS}"),
        (chain(20_000, "fixed"), f"20001 links; at most {MAX_LINKS}"),
        (chain(MAX_DEPTH + 1), f"{MAX_DEPTH + 1} joints follow one another"),
        (star(200_000), "MB, above 10.0 MB"),
        (chain(2).replace("<link ", "<link " + " ".join(f'a{i}="1"' for i in range(100_000)) + " ", 1), "attributes"),
    ],
    ids=["20,000 joints", "20,000 fixed joints", "too deep", "200,000 fixed links", "100,000 attributes"],
)
def test_what_is_too_large_is_refused_within_seconds(text, part, urdf):
    path = urdf.text(text)
    start = time.process_time()
    with pytest.raises(rt.InputError, match=part):
        rt.load(path)
    assert time.process_time() - start < 5.0


@pytest.mark.parametrize(
    ("text", "moving"),
    [(chain(100), 100), (chain(MAX_DEPTH), MAX_DEPTH), (star(MAX_LINKS - 1), 1)],
    ids=["100 joints", "deepest", "most links"],
)
def test_what_is_large_is_loaded_within_seconds(text, moving, urdf):
    path = urdf.text(text)
    start = time.process_time()
    assert rt.load(path).nv == moving
    assert time.process_time() - start < 5.0
