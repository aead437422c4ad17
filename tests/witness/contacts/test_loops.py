"""Closed loops in the witness: a parallelogram linkage is a pendulum."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import robotraj as rt
from robotraj.dynamics.contacts.loop_closure import LoopClosure
from robotraj.witness.contacts.stance import Stance
from robotraj.witness.simulation.integration import integrate
from robotraj.witness.simulation.simulate import robot_rates

LENGTH, BASE = 0.5, 0.8
CRANK, COUPLER, INERTIA = 1.2, 2.0, 0.03


def link(name: str, mass: float, x: float, z: float) -> str:
    return (
        f'<link name="{name}"><inertial><origin xyz="{x} 0 {z}"/><mass value="{mass}"/>'
        f'<inertia ixx="0.01" iyy="{INERTIA}" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def joint(name: str, kind: str, parent: str, child: str, x: float, z: float) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x} 0 {z}"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="50" effort="50"/></joint>'
    )


@pytest.fixture(scope="module")
def linkage(tmp_path_factory: pytest.TempPathFactory) -> rt.Robot:
    """Two equal cranks that hang ``BASE`` apart and a coupler as long as that between their ends."""
    parts = [
        '<link name="world_link"/>',
        link("left", CRANK, 0, -0.5 * LENGTH),
        link("coupler", COUPLER, 0.5 * BASE, 0),
        link("right", CRANK, 0, -0.5 * LENGTH),
        '<link name="coupler_end"/><link name="right_end"/>',
        joint("left_crank", "revolute", "world_link", "left", 0, 0),
        joint("knuckle", "revolute", "left", "coupler", 0, -LENGTH),
        joint("right_crank", "revolute", "world_link", "right", BASE, 0),
        joint("coupler_tip", "fixed", "coupler", "coupler_end", BASE, 0),
        joint("right_tip", "fixed", "right", "right_end", 0, -LENGTH),
    ]
    path: Path = tmp_path_factory.mktemp("linkage") / "linkage.urdf"
    path.write_text(f'<robot name="linkage">{"".join(parts)}</robot>')
    return rt.load(str(path), root="fixed")


def test_a_parallelogram_swings_as_the_pendulum_that_it_is(linkage):
    # The coupler does not turn: it is a point mass at the end of a crank.
    inertia = 2 * (INERTIA + CRANK * (0.5 * LENGTH) ** 2) + COUPLER * LENGTH**2
    gravity = 9.81 * (2 * CRANK * 0.5 * LENGTH + COUPLER * LENGTH)
    order = [list(linkage.velocity_names).index(name) for name in ("left_crank", "knuckle", "right_crank")]
    image = np.zeros(3)
    image[order] = [1.0, -1.0, 1.0]
    closed = Stance(linkage, [LoopClosure("coupler_end", "right_end").bind(linkage)], {})
    rates = robot_rates(linkage, lambda t, k, q, v: np.zeros(linkage.nu), closed.acceleration)
    x0 = np.concatenate([0.9 * image, -0.5 * image])
    motion = integrate(rates, x0, np.linspace(0, 2, 11), settle=closed.settle)
    textbook = solve_ivp(
        lambda t, x: [x[1], -gravity / inertia * np.sin(x[0])], (0, 2), [0.9, -0.5], method="DOP853",
        rtol=1e-12, atol=1e-13, t_eval=motion.times,
    ).y  # fmt: skip
    np.testing.assert_allclose(motion.states[:, :3], textbook[0][:, None] * image, atol=1e-9)
    np.testing.assert_allclose(motion.states[:, 3:], textbook[1][:, None] * image, atol=1e-8)


def test_a_loop_that_is_closed_twice_moves_as_if_closed_once_and_its_forces_are_not_claimed(linkage):
    once = LoopClosure("coupler_end", "right_end", name="once").bind(linkage)
    again = LoopClosure("right_end", "coupler_end", name="again").bind(linkage)
    single, double = Stance(linkage, [once], {}), Stance(linkage, [once, again], {})
    order = [list(linkage.velocity_names).index(name) for name in ("left_crank", "knuckle", "right_crank")]
    image = np.zeros(3)
    image[order] = [1.0, -1.0, 1.0]
    q, v, applied = 0.4 * image, 1.5 * image, np.array([0.3, -0.2, 0.5])
    np.testing.assert_allclose(double.acceleration(q, v, applied), single.acceleration(q, v, applied), atol=1e-11)
    force, unique = single.forces(q, v, applied, single.rows(q, v), {"once": np.zeros(2)})
    assert unique
    # The two closures share the force; what they exert against each other is as planned.
    planned = {"once": np.array([5.0, -3.0]), "again": np.array([2.0, 1.0])}
    shared, unique = double.forces(q, v, applied, double.rows(q, v), planned)
    assert not unique
    np.testing.assert_allclose(shared[:2] - shared[2:], force, atol=1e-9)
    np.testing.assert_allclose(shared[:2] + shared[2:], planned["once"] + planned["again"], atol=1e-9)
