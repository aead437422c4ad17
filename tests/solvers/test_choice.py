"""What plans a problem, and evaluates its functions, where the user does not say."""

from __future__ import annotations

import casadi as ca
import pytest

import robotraj as rt
from robotraj.planning.solver_choice import engine_for, solver_for
from robotraj.problem.objectives.base import Objective
from robotraj.solvers.base import Solver
from robotraj.solvers.stagewise.reduction import reduce


def chain(states: int, controls: int, **options: object) -> rt.Problem:
    """Integrators in a row, the last driven by all the controls."""
    names = [f"x{i}" for i in range(states)]
    inputs = [f"u{i}" for i in range(controls)]
    system = rt.System(names, inputs, lambda p: [*(p.x[name] for name in names[1:]), sum(p.u[i] for i in inputs)])
    ends = {"start": rt.State([0] * states), "end": rt.State([1] + [0] * (states - 1))}
    return rt.Problem([rt.Phase(system, **({"duration": 1.0, "objective": rt.Effort()} | ends | options))])  # type: ignore[arg-type]


def robot(name: str, **options: object) -> rt.Problem:
    return rt.Problem([rt.Phase(rt.load(name, **options), duration=1.0, objective=rt.Effort())])  # type: ignore[arg-type]


def test_systems_with_a_control_for_every_second_state_and_fixed_root_robots_are_for_fatrop() -> None:
    assert isinstance(solver_for(chain(1, 1), rt.Mesh()), rt.Fatrop)
    assert isinstance(solver_for(chain(2, 1), rt.Mesh()), rt.Fatrop)
    assert isinstance(solver_for(chain(4, 2), rt.Mesh()), rt.Fatrop)
    assert isinstance(solver_for(chain(3, 1), rt.Mesh()), rt.Ipopt)
    assert isinstance(solver_for(robot("ur5"), rt.Mesh()), rt.Fatrop)
    assert isinstance(solver_for(robot("cartpole"), rt.Mesh()), rt.Fatrop)


def test_rates_of_torques_and_jerks_leave_an_arm_to_fatrop_and_corners_do_not() -> None:
    arm = rt.load("cartpole")

    def chosen(objective: Objective) -> Solver:
        return solver_for(rt.Problem([rt.Phase(arm, 1.0, objective=objective)]), rt.Mesh())

    assert isinstance(chosen(rt.objectives.TorqueRate() + rt.Effort()), rt.Fatrop)
    assert isinstance(chosen(rt.objectives.Jerk()), rt.Fatrop)
    assert isinstance(chosen(rt.objectives.AbsolutePower()), rt.Ipopt)
    assert isinstance(chosen(rt.objectives.AbsolutePower() + rt.objectives.TorqueRate()), rt.Ipopt)


def test_every_phase_has_a_say() -> None:
    (good,), (bad,) = chain(2, 1).phases, chain(3, 1).phases
    assert isinstance(solver_for(rt.Problem([good, good]), rt.Mesh()), rt.Fatrop)
    assert isinstance(solver_for(rt.Problem([good, bad]), rt.Mesh()), rt.Ipopt)


@pytest.mark.parametrize(
    "options",
    [
        {"parameters": {"m": rt.between(1, 2)}},
        {"constraints": [rt.IntegralConstraint(lambda p: p.x["x0"], upper=3.0)]},
    ],
    ids=["parameters", "integral"],
)
def test_what_widens_stages_is_for_ipopt(options: dict[str, object]) -> None:
    assert isinstance(solver_for(chain(2, 1, **options), rt.Mesh()), rt.Ipopt)


def test_an_integral_over_an_arms_motion_widens_every_stage_and_is_for_ipopt() -> None:
    arm = rt.load("cartpole")
    budget = rt.IntegralConstraint(lambda p: p.tau[0] ** 2, upper=100.0, name="heat")
    bounded = rt.Problem([rt.Phase(arm, 1.0, objective=rt.Duration(), constraints=[budget])])
    assert isinstance(solver_for(bounded, rt.Mesh()), rt.Ipopt)
    # Every later stage carries what the integral has read so far.
    carried = [reduce(rt.transcription.transcribe(bounded, rt.Mesh(n))).program.nx.max() for n in (5, 10)]
    assert carried[1] > 1.8 * carried[0]


def test_what_has_no_stages_is_for_ipopt() -> None:
    assert isinstance(solver_for(chain(2, 1), rt.Mesh(10, rt.schemes.MultipleShooting())), rt.Ipopt)
    assert isinstance(solver_for(chain(2, 1), [rt.schemes.MovingMesh(5)]), rt.Ipopt)


def test_a_system_reaches_the_optimum_of_its_mesh_and_keeps_nothing_from_its_bounds() -> None:
    """A hull would ask for more than the bounds; for systems rows are imposed where a plan breaks them."""
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"]])
    phase = rt.Phase(
        system,
        duration=(0.1, 20.0),
        start=rt.State([0, 0]),
        end=rt.State([10, 0]),
        controls={"u": rt.between(-1, 1)},
        objective=rt.Duration(),
    )
    mesh = rt.Mesh(20, rt.HermiteSimpson(control=rt.schemes.ConstantControl()))
    plans = [rt.plan(phase, mesh, solver=solver) for solver in (None, rt.Ipopt())]
    assert plans[0].message.startswith("fatrop")
    assert plans[0].objective == pytest.approx(plans[1].objective, rel=1e-6)
    assert plans[0].objective == pytest.approx(2 * float(ca.sqrt(10)), rel=1e-6)


@pytest.mark.parametrize(
    ("name", "root", "actuated", "solver", "engine"),
    [
        ("ur5", "fixed", None, rt.Fatrop(), rt.engines.Native()),
        ("double_pendulum", "fixed", [], rt.Fatrop(), rt.engines.Native()),
        ("solo12", "floating", None, rt.Ipopt(), rt.engines.Native()),
    ],
)
def test_the_robot_decides(name: str, root: str, actuated: list[str] | None, solver: object, engine: object) -> None:
    robot = rt.load(name, root=root) if actuated is None else rt.load(name, root=root, actuated=actuated)
    problem = rt.Problem([rt.Phase(robot, 1.0, limits=None)])
    chosen = solver_for(problem, rt.Mesh(5))
    assert chosen == solver
    assert engine_for(problem, chosen) == engine
