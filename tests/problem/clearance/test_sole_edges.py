"""Soles over uneven ground: not only their corners but also their edges are clear of the edges of steps."""

import casadi as ca
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.problem.clearance.sole_edges import edge_places
from robotraj.problem.constraints.clearance_geometry import spots_of

SOLE = [("foot", (x, y, 0.0)) for x in (-0.1, 0.1) for y in (-0.04, 0.04)]
STAIR = rt.terrain.Steps.stairs(start=0.0, run=0.3, rise=0.1, count=1)


@pytest.fixture(scope="module")
def foot():
    """Return a foot that moves along x and z and turns about y."""
    model, place = pin.Model(), pin.SE3.Identity()
    joint = 0
    for kind, name in ((pin.JointModelPX(), "along"), (pin.JointModelPZ(), "up"), (pin.JointModelRY(), "pitch")):
        joint = model.addJoint(joint, kind, place, name)
    model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), 0.01 * np.eye(3)), place)
    model.addFrame(pin.Frame("foot", joint, 0, place, pin.FrameType.OP_FRAME))
    return rt.load(model)


def test_a_sole_has_four_edges_and_none_over_a_plane(foot):
    spots = spots_of(SOLE, foot)
    pairs = {(place.first.offset, place.second.offset) for place in edge_places(spots, STAIR)}
    assert len(pairs) == 4
    # An edge joins corners that differ in x or in y, a diagonal those that differ in both.
    assert all(np.count_nonzero(np.subtract(one, other)) == 1 for one, other in pairs)
    assert edge_places(spots, rt.terrain.Flat()) == edge_places(spots, rt.terrain.Slope(0.1)) == []


def test_the_place_over_a_nose_is_where_the_edge_crosses_it(foot):
    clear = rt.GroundClearance(SOLE, 0.0, STAIR)
    phase = rt.Phase(foot, 1.0, constraints=[clear])
    # Level at 0.12 m over the nose at x = 0: the gap there is 2 cm, at the rear corners 12 cm.
    sample = {"q": [0.0, 0.12, 0.0], "v": [0.0] * 3}
    rows = [row for row in phase.rows.path if "over x = 0 m" in row.label]
    symbols = phase.rows.symbols
    evaluate = ca.Function("rows", list(symbols), [ca.vertcat(*phase.rows.expressions(tuple(rows)))])
    arguments = [np.zeros(symbol.numel()) for symbol in symbols]
    arguments[1] = np.array([*sample["q"], *sample["v"]])
    gaps = np.array(evaluate(*arguments)).ravel()
    assert len(gaps) == 4
    # The edges across the nose are crossed at it; those along it are measured at their own x = -0.1 and 0.1 m.
    assert np.sort(gaps) == pytest.approx([0.02, 0.02, 0.02, 0.12], abs=1e-3)


@pytest.mark.parametrize("mesh", [None, rt.Mesh(20)])
def test_a_planned_sole_clears_the_nose_of_a_stair(foot, mesh):
    clear = rt.GroundClearance(SOLE, 0.0, STAIR)
    start, end = rt.State(q=[-0.2, 0.001, 0.0], v=0), rt.State(q=[0.15, 0.101, 0.0], v=0)
    plan = rt.plan(rt.Phase(foot, 1.0, start, end, rt.Effort(), constraints=[clear]), mesh=mesh)
    report = rt.validate(plan)
    assert report.passed and not report.violations
    times = np.linspace(0.0, 1.0, 801)
    x, z, pitch = plan.at(times).q.T
    along = np.linspace(-0.1, 0.1, 401)[:, None]
    height = z - along * np.sin(pitch)
    assert np.min(height - STAIR.height(x + along * np.cos(pitch), 0.0 * along + 0.0 * x)) > -1e-3
