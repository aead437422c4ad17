"""A contact kind from outside the package is planned, replayed, saved and used by gaits like those inside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact, Contact, Wrench, force_variables, held_rows, spread
from robotraj.dynamics.point import FramePoint
from robotraj.dynamics.row import Row
from robotraj.dynamics.variable import Scalar
from robotraj.replay_page.footholds import footholds
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import gait_cycles


@dataclass(frozen=True)
class Ice(Contact):
    """A frame that slides without friction on the level ground."""

    frame: str
    friction = 0.0

    @property
    def label(self) -> str:
        """Name of the contact."""
        return self.frame

    def bind(self, robot: Robot) -> BoundIce:
        """Hold the height of the frame."""
        row = Row("normal force", "N", 0.0, np.inf, self.frame, f"force.{self.frame}.z")
        forces, held = force_variables(self.frame, (2,)), held_rows(self.frame, (2,))
        return BoundIce(self, self.frame, self.frame, forces, (), held, (row,), ())


@dataclass(frozen=True, eq=False)
class BoundIce(BoundContact):
    """The contact of one robot."""

    def position(self, point: FramePoint, anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Height."""
        return [point.frame(self.frame).position[2]]

    def velocity(self, point: FramePoint) -> list[Scalar]:
        """Vertical velocity."""
        return [point.frame(self.frame).velocity[2]]

    def acceleration(self, point: FramePoint) -> list[Scalar]:
        """Vertical acceleration."""
        return [point.frame(self.frame).acceleration[2]]

    def vector(self, forces: Sequence[Scalar]) -> list[Scalar]:
        """Vertical force."""
        return spread(forces, (2,))

    def wrench(self, point: FramePoint, forces: Sequence[Scalar]) -> list[Wrench]:
        """Force at the frame's origin."""
        return [(self.frame, [*self.vector(forces), 0.0, 0.0, 0.0])]

    def limits(self, point: FramePoint, forces: Sequence[Scalar], anchors: Mapping[str, Scalar]) -> list[Scalar]:
        """Normal force."""
        return [forces[0]]


def sliding() -> rt.Phase:
    """Lean forward on ice."""
    start = rt.State(q={"root_x": 0.0, "root_pitch": 0.0, "hip": 0.0}, v=0)
    end = rt.State(q={"root_pitch": 0.1}, v=0)
    return rt.Phase(rt.load("hopper", root="planar"), 0.3, start, end, rt.Effort(), contacts=[Ice("foot")])


@pytest.fixture(scope="module")
def slid() -> rt.Solution:
    """A plan on a fixed mesh."""
    return rt.plan(sliding(), mesh=rt.Mesh(8, rt.schemes.LobattoIIIA(4)))


def test_its_foothold_slides_with_its_frame_and_has_no_cone(slid: rt.Solution, tmp_path: Path) -> None:
    (hold,) = footholds(gait_cycles(slid).phases[0])
    assert not hold.stays
    assert hold.angle == 0.0
    np.testing.assert_allclose(hold.normal, [0.0, 0.0, 1.0])
    times, places, _ = hold.track
    robot, height = slid.phases[0].phase.robot, places[:, 2]
    assert robot is not None
    np.testing.assert_allclose(height[np.isin(times, slid.knots)], 0.0, atol=1e-6)
    assert rt.replay(slid, tmp_path / "slid.html").exists()


def test_a_file_holds_its_forces_and_the_problem_gives_its_equations_back(slid: rt.Solution, tmp_path: Path) -> None:
    path = slid.save(tmp_path / "slid.npz")
    with pytest.warns(UserWarning, match=r"the equations of contact Ice\(frame='foot'\)"):
        loaded = rt.load_solution(path)
    times = slid.knots
    np.testing.assert_allclose(loaded.at(times).forces["foot"], slid.at(times).forces["foot"], atol=1e-6)
    assert rt.replay(loaded, tmp_path / "loaded.html").exists()
    with pytest.raises(rt.InputError, match=r"contact Ice\(frame='foot'\).*problem="):
        rt.plan(loaded.problem)
    whole = rt.load_solution(path, problem=sliding())
    assert isinstance(whole.phases[0].phase.contacts[0], Ice)


def test_a_walk_on_ice_starts_at_a_finite_height() -> None:
    robot = rt.load("five_link", root="planar")
    walk = rt.gait.walk(robot, step_length=0.4, duration=0.7, contact=Ice)
    bounds = [b for phase in walk.phases for each in phase.joint_ends.values() for b in (each.lower, each.upper)]
    assert not any(np.isnan(side).any() for side in bounds)
    assert walk.phases[0].contacts[0] == Ice("left_foot")


def test_ground_for_a_contact_without_that_field_is_refused() -> None:
    robot = rt.load("five_link", root="planar")
    with pytest.raises(rt.InputError, match="Ice 'left_foot' stands on level ground; give its class a field 'ground'"):
        rt.gait.walk(robot, step_length=0.4, duration=0.7, contact=Ice, ground=rt.terrain.Slope(0.1))
