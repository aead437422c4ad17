"""Where finer meshes lead astray, controls become lines on every interval."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import fsolve

import robotraj as rt
from robotraj.planning.loop import run as loop
from robotraj.planning.loop import to_tolerance
from robotraj.transcription.refinement.linear_controls import LINES, on_lines

ENDLESS = rt.InteriorPoint.max_iterations

LENGTH = 4.0


def hanging_chain() -> rt.Phase:
    """A chain of 4 m between the heights 1 and 3 m, 1 m apart, whose centre of mass is as low as possible."""
    slope = rt.System(["x"], ["u"], lambda point: [point.u["u"]])

    def arc(point):
        return ca.sqrt(1 + point.u["u"] ** 2)

    return rt.Phase(
        slope,
        1.0,
        rt.State([1]),
        rt.State([3]),
        objective=rt.Lagrange(lambda point: point.x["x"] * arc(point)),
        constraints=[rt.constraints.IntegralConstraint(arc, LENGTH, LENGTH)],
    )


def catenary() -> float:
    """The integral of x ds along x = a cosh((t - b) / a) + c."""

    def off(unknowns):
        a, b, c = unknowns
        length = a * (np.sinh((1 - b) / a) + np.sinh(b / a))
        return a * np.cosh(b / a) + c - 1, a * np.cosh((1 - b) / a) + c - 3, length - LENGTH

    a, b, c = fsolve(off, [0.2, 0.3, 0.0], xtol=1e-13)
    return quad(lambda t: (a * np.cosh((t - b) / a) + c) * np.cosh((t - b) / a), 0, 1, epsabs=1e-12)[0]


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-6}])
def test_a_chain_hangs_as_a_catenary(options):
    """The quadrature of its length is exact for small slopes alone; free controls in the middles exploit that."""
    solution = rt.plan(hanging_chain(), progress=False, **options)
    assert solution.objective == pytest.approx(catenary(), rel=2e-6)
    # With a tolerance a higher order may succeed before lines are tried, depending on round-off.
    assert options or solution.phases[0].mesh.given == (LINES,)


@pytest.mark.parametrize(("module", "options"), [(loop, {}), (to_tolerance, {"tolerance": 1e-4})])
def test_controls_are_lines_where_a_first_mesh_is_exploited_without_end(monkeypatch, module, options):
    real, meshes = module.solved_at_points, []

    def endless_at_first(*given, **named):
        found = real(*given, **named)
        meshes.append(found.solution.phases[0].mesh.given)
        ended = found.changed(status=rt.solvers.Status.ITERATION_LIMIT, iterations=ENDLESS)
        return found if len(meshes) > 1 else ended

    monkeypatch.setattr(module, "solved_at_points", endless_at_first)
    solution = rt.plan(hanging_chain(), progress=False, **options)
    assert meshes[0] != (LINES,) and set(meshes[1:]) == {(LINES,)}
    assert solution.objective == pytest.approx(catenary(), rel=2e-4)


def test_lines_that_end_without_a_solution_start_again_from_the_guess(monkeypatch):
    """The second mesh is exploited, and its solution may lead away on lines too, depending on round-off."""
    real, starts = loop.solved_at_points, []

    def endless_on_lines(problem, guess, *others, **named):
        found = real(problem, guess, *others, **named)
        if found.solution.phases[0].mesh.given != (LINES,):
            return found
        starts.append(guess)
        if len(starts) > 1:
            return found
        return found.changed(status=rt.solvers.Status.ITERATION_LIMIT, iterations=ENDLESS)

    monkeypatch.setattr(loop, "solved_at_points", endless_on_lines)
    solution = rt.plan(hanging_chain(), progress=False)
    assert starts[0] is not None and starts[1] is None
    assert solution.success and solution.objective == pytest.approx(catenary(), rel=2e-4)


def test_an_exact_motion_shooting_and_contacts_keep_their_schemes():
    arm, system = rt.Phase(rt.load("ur5"), 1.0), hanging_chain()
    meshes = (rt.Mesh(4, rt.schemes.RadauIIA(3)), rt.Mesh(5, rt.schemes.RadauIIA(3)))
    assert on_lines(rt.Problem([arm, system]), meshes) == (meshes[0], rt.Mesh(5, LINES))
    shooting = (rt.Mesh(5, rt.schemes.MultipleShooting()),)
    assert on_lines(rt.Problem([system]), shooting) == shooting
    step = rt.gait.walk(rt.load("five_link", root="planar"), step_length=0.5, duration=0.7)
    steps = (rt.Mesh(6),) * len(step.phases)
    assert on_lines(step, steps) == steps


def induced_reactor() -> rt.Phase:
    """Protein from a fed-batch reactor, by feeds of nutrient and inducer.

    Source: Lee and Ramirez, Optimal fed-batch control of induced foreign protein production, AIChE Journal 40 (1994).
    """
    names = ["volume", "cells", "nutrient", "protein", "inducer", "shock", "recovery"]

    def rates(point):
        volume, cells, nutrient, _, inducer, shock, recovery = (point.x[name] for name in names)
        feed, induced = point.u["feed"], point.u["induced"]
        uptake = nutrient / (14.35 + nutrient + nutrient**2 / 111.5)
        growth = uptake * (shock + 0.22 * recovery / (0.22 + inducer))
        product = 0.233 * uptake * (0.0005 + inducer) / (0.022 + inducer)
        lost, dilution = 0.09 * inducer / (0.034 + inducer), (feed + induced) / volume
        return [
            feed + induced,
            (growth - dilution) * cells,
            100 * feed / volume - dilution * nutrient - growth * cells / 0.51,
            product * cells - dilution * point.x["protein"],
            4 * induced / volume - dilution * inducer,
            -lost * shock,
            lost * (1 - recovery),
        ]

    return rt.Phase(
        rt.System(names, ["feed", "induced"], rates),
        10.0,
        rt.State([1, 0.1, 40, 0, 0, 1, 0]),
        objective=rt.Mayer(lambda _, last: -last.x["volume"] * last.x["protein"]),
        controls={"feed": rt.between(0, 1), "induced": rt.between(0, 1)},
        states={name: rt.between(0.5 if name == "volume" else 0.0, np.inf) for name in names},
    )


def test_controls_become_lines_where_the_error_hardly_falls():
    """On the reactor's singular arcs free controls alternate; the best known product is 6.1516."""
    solution = rt.plan(induced_reactor(), progress=False, tolerance=1e-6)
    assert solution.success and solution.error <= 1e-6
    assert solution.objective == pytest.approx(-6.1516, abs=1e-4)
    assert solution.phases[0].mesh.given == (LINES,)
    assert solution.iterations >= sum(step.iterations for step in solution.refinement)
