import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj._util.errors import InputError

pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")


@pytest.fixture(scope="module")
def four_bar():
    """A parallelogram in the x-z plane: crank and rocker of 0.3 m, a coupler of 0.5 m, its end pinned to the world."""
    model = pin.Model()
    parent, where = 0, pin.SE3.Identity()
    for name, length in (("crank", 0.3), ("coupler", 0.5), ("rocker", 0.3)):
        parent = model.addJoint(parent, pin.JointModelRY(), where, name)
        middle = pin.SE3(np.eye(3), np.array([0.5 * length, 0.0, 0.0]))
        model.appendBodyToJoint(parent, pin.Inertia.FromCylinder(1.0, 0.02, length), middle)
        where = pin.SE3(np.eye(3), np.array([length, 0.0, 0.0]))
    model.addFrame(pin.Frame("end", parent, 0, where, pin.FrameType.OP_FRAME))
    pin_at = pin.SE3(np.eye(3), np.array([0.5, 0.0, 0.0]))
    model.addFrame(pin.Frame("pivot", 0, 0, pin_at, pin.FrameType.OP_FRAME))
    return rt.load(model, actuated=["crank"])


def angles(turn):
    """Joint positions of the parallelogram whose crank is turned: the coupler stays level, the rocker points back."""
    return [turn, -turn, np.pi + turn]


def swing(robot, contacts, name="swing", **phase):
    return rt.Phase(robot, contacts=contacts, objective=rt.Effort(), limits=None, name=name, **phase)


def test_a_four_bar_moves_as_planned(four_bar):
    start, end = rt.State(q=angles(-1.0), v=0), rt.State(q=angles(-2.0), v=0)
    closed = swing(four_bar, [rt.contacts.LoopClosure("end", "pivot")], duration=0.8, start=start, end=end)
    solution = rt.plan(closed, mesh=rt.Mesh(12, rt.HermiteSimpson()))
    alone, held = (rt.witness.second_opinion(solution, feedback=f, step=2e-4) for f in (rt.witness.NoFeedback(), None))
    assert alone.completed and alone.deviation.largest("q.") < 0.02
    assert held.completed and held.deviation.largest("q.") < 2e-3
    assert not held.feet
    data = four_bar.model.createData()
    for q in held.simulation.q[::50]:
        pin.framesForwardKinematics(four_bar.model, data, q)
        np.testing.assert_allclose(data.oMf[four_bar.frame("end")].translation, [0.5, 0.0, 0.0], atol=1e-4)


def test_loops_stay_closed(four_bar):
    closed = swing(
        four_bar, [rt.contacts.LoopClosure("end", "pivot")], "closed", duration=0.2, start=rt.State(q=angles(-1.0), v=0)
    )
    opened = swing(four_bar, [], "opened", duration=0.2)
    problem = rt.Problem([closed, opened], links=[rt.links.Liftoff(0, 1)])
    solution = rt.plan(problem, mesh=rt.Mesh(4, rt.HermiteSimpson()), check=False)
    with pytest.raises(InputError, match="Phase 'opened' opens the loop 'end-pivot'"):
        rt.witness.second_opinion(solution)
