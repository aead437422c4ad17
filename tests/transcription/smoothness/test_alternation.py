"""What alternates with the mesh is the highest degree of an interval, and costs time where a duration is minimised."""

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.smoothness.alternation import ALTERNATING, alternation_cost, highest_coefficient
from robotraj.transcription.smoothness.roughness import roughness

SCHEMES = (rt.HermiteSimpson(), rt.schemes.FifthDegree(), rt.schemes.RadauIIA(3), rt.schemes.GaussLegendre(3))


@pytest.mark.parametrize("scheme", SCHEMES, ids=repr)
def test_lower_degrees_do_not_alternate(scheme):
    nodes = scheme.nodes
    factors = highest_coefficient(nodes)
    assert np.abs(factors).max() == 1.0
    for degree in range(len(nodes) - 1):
        assert abs(factors @ nodes**degree) < 1e-12
    assert abs(factors @ nodes ** (len(nodes) - 1)) > 1e-2


def test_hermite_simpson_compares_the_middle_with_the_chord():
    assert np.allclose(np.abs(highest_coefficient(np.array([0.0, 0.5, 1.0]))), [0.5, 1.0, 0.5])


def test_of_smooth_curves_the_square_falls_with_the_fourth_power_of_the_length():
    """e falls with the square of the length of an interval, and counts squared."""
    nodes, costs = np.array([0.0, 0.5, 1.0]), []
    for count in (20, 40):
        starts = np.arange(count)[:, None] / count
        costs.append(np.mean((np.sin(5.0 * (starts + nodes / count)) @ highest_coefficient(nodes)) ** 2))
    assert costs[0] / costs[1] == pytest.approx(16.0, rel=0.02)


def test_the_cost_is_that_of_the_accelerations_of_a_block():
    """A block of mass m at rest but for its acceleration: r = (m e / tau)^2 / 1, integrated over the phase."""
    block = rt.load("block")
    limits = block.limits.with_(effort=10.0)
    phase = rt.Phase(block, (0.1, 5.0), rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Duration(), limits=limits)
    part = rt.plan(phase, mesh=rt.Mesh(7)).phases[0]
    a = part.trajectory.z.inside(np.array([0.0, 0.5, 1.0]))[:, :, 0]
    mass = block.model.inertias[1].mass
    e = a[:, 1] - 0.5 * (a[:, 0] + a[:, 2])
    wanted = ALTERNATING * np.mean((mass * e / 10.0) ** 2) * part.duration
    assert wanted > 0.0
    assert alternation_cost(part.phase, part.trajectory, part.mesh.schemes, 1.0) == pytest.approx(wanted)


def around_a_post():
    post = rt.CollisionFree([rt.obstacles.Box((0.1, 0.1, 0.3), position=(0.52, 0.07, 0.47))], margin=0.01)
    ends = (rt.State(q=[side, -1.8, 1.6, -1.2, -1.57, 0.0], v=0) for side in (-1.1, 1.1))
    return rt.Phase(rt.load("ur5"), (0.2, 5.0), *ends, rt.Duration(), [post])


@pytest.mark.slow
def test_least_time_beside_a_post_has_no_teeth_and_takes_no_longer():
    """Without smoothing the torques alternate by several percent of their limit on the same mesh."""
    mesh, found = rt.Mesh(60), []
    for smoothing in (0.0, 5e-3):
        plan = rt.plan(around_a_post(), mesh=mesh, smoothing=smoothing)
        assert plan.objective == pytest.approx(plan.duration, abs=1e-9)
        part = plan.phases[0]
        found.append((roughness(part.phase, part.trajectory, part.inputs).max(), plan.duration))
    (rough, before), (smooth, after) = found
    assert rough > 0.04
    assert smooth < 0.01
    assert after < before * (1.0 + 1e-3)
