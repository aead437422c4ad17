"""Masses, inertias and poses that follow from shapes, classes and conventions are those of MuJoCo."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
CORNERS = (
    "0 0 0 .25 0 0 .25 .125 0 .125 .125 0 .125 .25 0 0 .25 0 "
    "0 0 .5 .25 0 .5 .25 .125 .5 .125 .125 .5 .125 .25 .5 0 .25 .5"
)
"""Of an L, which is not convex, in numbers that MuJoCo's single precision keeps."""
SIDES = (
    "0 2 1 0 3 2 0 4 3 0 5 4 6 7 8 6 8 9 6 9 10 6 10 11 0 1 7 0 7 6 1 2 8 1 8 7 2 3 9 2 9 8 3 4 10 3 10 9 "
    "4 5 11 4 11 10 5 0 6 5 6 11"
)


def text(numbers: np.ndarray) -> str:
    return " ".join(repr(float(number)) for number in np.atleast_1d(numbers))


def turned(rng: np.random.Generator) -> str:
    """Draw an orientation by any of the attributes."""
    kinds = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}
    kind = str(rng.choice([*kinds]))
    return f'{kind}="{text(rng.normal(size=kinds[kind]))}"'


def geom(rng: np.random.Generator) -> str:
    """Draw a shape, its mass from itself, its density, its class or the default."""
    kind = str(rng.choice([*SIZES, "mesh"]))
    mass = str(rng.choice(['mass="0.7"', 'density="300"', 'class="light"', ""]))
    if kind == "mesh":
        return f'<geom type="mesh" mesh="l" pos="{text(rng.normal(size=3))}" {turned(rng)} {mass}/>'
    size = text(rng.uniform(0.02, 0.2, SIZES[kind]))
    if kind != "sphere" and rng.random() < 0.4:
        return f'<geom type="{kind}" size="{size}" fromto="{text(rng.normal(size=6))}" {mass}/>'
    return f'<geom type="{kind}" size="{size}" pos="{text(rng.normal(size=3))}" {turned(rng)} {mass}/>'


def body(rng: np.random.Generator, number: int, inside: str, more: str) -> str:
    kind, axis = str(rng.choice(["hinge", "slide"])), text(rng.normal(size=3))
    joint = f'<joint name="j{number}" type="{kind}" axis="{axis}" {more}/>'
    shapes = "".join(geom(rng) for _ in range(rng.integers(1, 4)))
    if rng.random() < 0.2:
        shapes = '<inertial pos="0.1 0 0" mass="2" fullinertia="0.3 0.02 0.03 0.01 0 0.002"/>'
    return f'<body name="b{number}" pos="{text(rng.normal(size=3))}" {turned(rng)}>{joint}{shapes}{inside}</body>'


def scene(seed: int) -> str:
    """Draw two robots on tables of the world, with the sections that they use after them."""
    rng = np.random.default_rng([46, seed])
    first = body(rng, 1, body(rng, 2, body(rng, 3, "", 'class="off"'), ""), "")
    second = body(rng, 4, body(rng, 5, "", ""), 'class="off"')
    table = f'<body name="table" pos="0.1 0 1" {turned(rng)}><geom type="box" size="1 1 0.1"/>{second}</body>'
    angle, sequence = rng.choice(["radian", "degree"]), "".join(rng.permutation([*"xYz"]))
    total = rng.choice(["", 'settotalmass="7"'])
    moved = rng.choice(["", 'refpos="0.1 -0.2 0.3" refquat="0.5 0.1 -0.7 0.2" scale="1 -2 0.5"'])
    kind = rng.choice(["exact", "legacy", "convex"])
    mesh = f'<mesh name="l" {moved} inertia="{kind}" vertex="{CORNERS}" face="{SIDES}"/>'
    return (
        f'<mujoco><worldbody>{first}<geom type="plane" size="9 9 1" pos="0 0 -9"/></worldbody>'
        f"<worldbody>{table}</worldbody>"
        f'<compiler angle="{angle}" eulerseq="{sequence}" balanceinertia="true" {total}/><asset>{mesh}</asset>'
        '<default><geom density="900"/><joint damping="0.2"/><default class="light"><geom mass="0.1"/></default>'
        '<default class="off"><joint pos="0.1 0.2 0.3" armature="0.01"/></default></default></mujoco>'
    )


@pytest.mark.parametrize("seed", range(12))
def test_drawn_scenes_move_as_in_mujoco(seed: int, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "scene.xml"
    path.write_text(scene(seed))
    robot, judge = rt.load(path), mujoco.MjModel.from_xml_path(str(path))
    judge.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    assert robot.velocity_names == tuple(f"j{number}" for number in range(1, 6))
    state, data, rng = mujoco.MjData(judge), robot.model.createData(), np.random.default_rng(seed)
    for _ in range(3):
        q, v, tau = rng.uniform(-1.0, 1.0, (3, 5))
        state.qpos[:], state.qvel[:], state.qfrc_applied[:] = q, v, tau
        mujoco.mj_forward(judge, state)
        own = pin.aba(robot.model, data, q, v, tau - robot.damping * v)
        np.testing.assert_allclose(own, state.qacc, rtol=1e-8, atol=1e-8 * np.abs(state.qacc).max())
        pin.framesForwardKinematics(robot.model, data, q)
        for name in ("table", "b3", "b5"):
            place = data.oMf[robot.frame(name)]
            np.testing.assert_allclose(place.translation, state.body(name).xpos, atol=1e-12)
            np.testing.assert_allclose(place.rotation.ravel(), state.body(name).xmat, atol=1e-12)


@pytest.mark.parametrize("shape", ['type="sphere" size="0.1" shellinertia="true"', 'type="sdf"', 'type="box" mesh="l"'])
def test_shapes_of_unknown_mass_are_refused_where_it_counts(shape: str, tmp_path: Path) -> None:
    """A stated inertia, or no mass, makes them shapes like others."""
    path, mesh = tmp_path / "one.xml", f'<asset><mesh name="l" vertex="{CORNERS}" face="{SIDES}"/></asset>'
    file = '<mujoco>{}<worldbody><body name="b"><joint name="j"/><geom {}/></body></worldbody></mujoco>'
    path.write_text(file.format(mesh, f'name="round" {shape}'))
    with pytest.raises(rt.InputError, match="mass of the <geom> 'round'.*give its body an <inertial>"):
        rt.load(path)


def test_inertias_follow_the_switches_of_the_compiler(tmp_path: Path) -> None:
    """``inertiafromgeom`` overrides what is stated, or leaves the body without mass; groups choose shapes."""
    path = tmp_path / "one.xml"

    def mass(switch: str) -> float:
        path.write_text(
            f'<mujoco><compiler {switch}/><worldbody><body name="b"><joint name="j"/><inertial pos="0 0 0" mass="3" '
            'diaginertia="1 1 1"/><geom size="0.1" mass="1" group="2"/><geom size="0.1" mass="5" group="4"/></body>'
            "</worldbody></mujoco>"
        )
        return float(rt.load(path).mass)

    assert mass("") == mass('inertiafromgeom="false"') == pytest.approx(3.0)
    assert mass('inertiafromgeom="true"') == pytest.approx(6.0)
    assert mass('inertiafromgeom="true" inertiagrouprange="0 3"') == pytest.approx(1.0)
    assert mass('settotalmass="2"') == pytest.approx(2.0)


def test_vertices_are_those_of_mujoco_where_the_mesh_has_a_reference(tmp_path: Path) -> None:
    """MuJoCo moves each mesh to its own centre, and the shape with it."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "one.xml"
    mesh = f'<mesh name="l" refpos="0.1 0.2 -0.3" refquat="0.5 0.1 -0.7 0.2" scale="1 -2 0.5" vertex="{CORNERS}"'
    path.write_text(
        f'<mujoco><asset>{mesh} face="{SIDES}"/></asset><worldbody><body name="b"><joint name="j"/>'
        '<geom type="mesh" mesh="l" pos="0.3 0 0" quat="0.5 0.5 0.1 0.2"/></body></worldbody></mujoco>'
    )
    judge = mujoco.MjModel.from_xml_path(str(path))
    place = pin.SE3(pin.Quaternion(*judge.geom_quat[0]).toRotationMatrix(), judge.geom_pos[0])
    (shape,) = rt.load(path).collision_model.geometryObjects
    own = np.array([shape.placement.act(corner) for corner in np.array(shape.geometry.vertices())])
    theirs = np.array([place.act(corner.astype(float)) for corner in judge.mesh_vert])
    apart = np.linalg.norm(own[:, None] - theirs[None], axis=2)
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-5
