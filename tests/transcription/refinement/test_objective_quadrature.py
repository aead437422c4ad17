"""What a scheme's sum leaves of the objective's integral."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.transcription.refinement.objective_quadrature import quadrature_errors, surplus


def test_the_error_is_the_difference_to_the_integral_along_the_motion() -> None:
    phase = rt.Phase(rt.load("ur5"), 1.0, rt.State(q=0, v=0), rt.State(q=1.0, v=0), rt.Effort() + 3.0 * rt.Duration())
    solution = rt.plan(phase, mesh=rt.Mesh(6))
    (part,) = solution.phases
    errors = quadrature_errors(phase, part.trajectory, part.mesh.schemes, part.inputs)
    total = 0.0
    for k, (first, last) in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):
        t = np.linspace(first, last, 2001)
        tau = np.array(part.at(t, interval=k).tau)
        total += float(np.trapezoid((tau**2).sum(axis=1), t))
    assert solution.objective - 3.0 - total == pytest.approx(errors.sum(), rel=2e-3)
    assert abs(errors.sum()) > 1e-4 * total


def test_durations_alone_have_no_integral() -> None:
    phase = rt.Phase(rt.load("ur5"), (0.2, 5), rt.State(q=0, v=0), rt.State(q=1.0, v=0), rt.Duration())
    part = rt.plan(phase, mesh=rt.Mesh(6)).phases[0]
    assert not quadrature_errors(phase, part.trajectory, part.mesh.schemes, part.inputs).any()


def test_the_error_of_a_rate_of_time() -> None:
    """From rest to rest over 1 m in 1 s u^2 integrates to 12, by Simpson's rule too. It misses 1 / 7, that of t^6."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    rate = rt.Lagrange(lambda point: point.u["u"] ** 2 + point.t**6)
    phase = rt.Phase(block, 1.0, rt.State([0, 0]), rt.State([1, 0]), rate)
    solution = rt.plan(phase, rt.Mesh(3, rt.schemes.HermiteSimpson()))
    (part,) = solution.phases
    errors = quadrature_errors(phase, part.trajectory, part.mesh.schemes, part.inputs)
    assert errors.sum() == pytest.approx(solution.objective - 12.0 - 1.0 / 7.0, abs=1e-8)
    assert errors.sum() > 1e-4


def test_slacks_have_their_least_values_in_the_objective_and_in_its_error() -> None:
    """Solutions of large barriers differ from the optimum, and their slacks from the least ones."""
    cart = rt.System(["x", "v"], ["F"], lambda point: [point.x["v"], point.u["F"]])
    work = rt.objectives.AbsolutePower(speeds={"F": "v"})
    phase = rt.Phase(cart, 1.0, rt.State([0, 0]), rt.State([1, 0]), work, controls={"F": rt.between(-20, 20)})
    solution = rt.plan(phase, rt.Mesh(40, rt.schemes.RadauIIA(3)), solver=rt.InteriorPoint(tolerance=1e-2))
    (part,) = solution.phases
    scheme, total, true = part.mesh.schemes[0], 0.0, 0.0
    for k, (first, last) in enumerate(zip(part.knots[:-1], part.knots[1:], strict=True)):
        nodes = part.at(first + (last - first) * scheme.nodes, interval=k)
        total += (last - first) * float(scheme.objective_weights @ np.abs(nodes.u["F"] * nodes.x["v"]))
        t = np.linspace(first, last, 2001)
        motion = part.at(t, interval=k)
        true += float(np.trapezoid(np.abs(motion.u["F"] * motion.x["v"]), t))
    assert solution.objective == pytest.approx(total, rel=1e-9)
    assert surplus(phase, part.trajectory, part.mesh.schemes) > 1e-2 * total
    errors = quadrature_errors(phase, part.trajectory, part.mesh.schemes, part.inputs)
    assert errors.sum() == pytest.approx(total - true, rel=0.05)  # Gauss's rule, across kinks
