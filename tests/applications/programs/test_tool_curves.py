"""Twists of curves of poses are derivatives of these; polynomials of degree five have their ends."""

import numpy as np
import pinocchio as pin

from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.applications.programs.tool_curves import ToolBlend, arc, line, twist_rates
from robotraj.applications.programs.tool_joints import SITES, hermite

RNG = np.random.default_rng(5)


def test_twists_and_their_rates_are_derivatives_of_the_pose():
    first, last = pin.SE3.Random(), pin.SE3.Random()
    corner = pin.exp3(RNG.uniform(-1, 1, 3))
    curve = PiecewisePolynomial(np.array([0.0, 0.7]), [SITES], [RNG.uniform(-1, 1, (6, 6))])
    for way in (line(first, last), arc(first, RNG.uniform(-1, 1, 3), last, "arc"), ToolBlend(corner, curve)):
        for last_end in (False, True):
            step, s = 1e-4, 0.3

            def at(place, way=way, last_end=last_end):
                return twist_rates(way.rotation(last_end), way.state(place, last_end))

            before, (_, twist, rate), after = at(s - step), at(s), at(s + step)
            moved = (after[0].translation - before[0].translation) / (2 * step)
            turned = pin.log3(after[0].rotation @ before[0].rotation.T) / (2 * step)
            assert np.allclose(np.concatenate([moved, turned]), twist, atol=1e-5)
            assert np.allclose((after[1] - before[1]) / (2 * step), rate, atol=1e-4)


def test_a_move_has_its_ends_about_either_rotation():
    first, last = pin.SE3.Random(), pin.SE3.Random()
    for way in (line(first, last), arc(first, RNG.uniform(-1, 1, 3), last, "arc")):
        for last_end in (False, True):
            for s, end in ((0.0, first), (way.length, last)):
                found = twist_rates(way.rotation(last_end), way.state(s, last_end))[0]
                assert found.isApprox(end, 1e-9)


def test_polynomials_have_the_values_and_two_derivatives_of_both_ends():
    first, last = RNG.uniform(-1, 1, (2, 3, 4))
    curve = PiecewisePolynomial(np.array([0.0, 0.3]), [SITES], [hermite(first, last, 0.3)])
    for order in range(3):
        assert np.allclose(curve(0.0), first[order], atol=1e-9)
        assert np.allclose(curve(0.3), last[order], atol=1e-9)
        curve = curve.derivative()
