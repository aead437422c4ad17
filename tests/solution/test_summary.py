"""What ``print(solution)`` shows."""

import numpy as np
import pytest

import robotraj as rt

PENDULUM = rt.load("pendulum")


def lift(effort: float) -> rt.Solution:
    phase = rt.Phase(
        PENDULUM,
        0.05,
        rt.State(q=0, v=0),
        rt.State(q=np.pi, v=0),
        rt.Effort(),
        limits=PENDULUM.limits.with_(effort=effort, velocity=np.inf),
    )
    return rt.plan(phase, mesh=rt.Mesh(10), check=False)


def test_only_a_motion_that_satisfies_its_rows_prints_errors_between_its_knots() -> None:
    solved, unsolved = lift(1e6), lift(0.1)
    assert solved.success and not unsolved.success
    assert "error between knots" in str(solved)
    assert "between" not in str(unsolved)
    assert str(unsolved).splitlines()[-1].startswith("try: ")


def test_a_solution_prints_within_80_columns_and_its_repr_on_one_line() -> None:
    for solution in (lift(1e6), lift(0.1)):
        assert max(map(len, str(solution).splitlines())) <= 80
        assert "\n" not in repr(solution) and len(repr(solution)) < 200


def test_a_power_exceeded_between_the_points_is_printed_and_the_default_plan_keeps_to_it() -> None:
    """Rows of torques are imposed at collocation points with tolerance=; nothing but the report tells of the rest."""
    robot = rt.load("two_link_arm")
    limits = robot.limits.with_(effort=30.0, velocity=10.0)
    power = rt.PathConstraint(lambda p: [p.tau[i] * p.v[i] for i in (0, 1)], [-6, -6], [6, 6], name="power", unit="W")
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1.0, 0.5], v=0)
    phase = rt.Phase(robot, (0.3, 5.0), *ends, rt.Duration(), limits=limits, constraints=[power])

    def largest(solution: rt.Solution) -> float:
        sample = solution.at(np.linspace(0, solution.duration, 4001))
        return float(np.abs(sample.tau * sample.v).max())

    rough, proved = rt.plan(phase, tolerance=1e-3), rt.plan(phase)
    assert largest(rough) > 6.5
    text = " ".join(str(rough).split())
    assert "power[" in text.split("between collocation points: ")[1] and "plan without mesh= and tolerance=" in text
    assert largest(proved) < 6.0 * 1.002
    assert "between collocation points" not in str(proved)


def test_accelerations_that_no_gear_gives_are_doubted_and_limits_remove_the_doubt() -> None:
    """A URDF has no rotors, so a wrist in least time accelerates with its torque over the inertia of its links."""
    ur5 = rt.load("ur5")
    ends = rt.State(q=[0.2, -1.6, 1.2, -1.2, -1.57, 0.0], v=0), rt.State(q=[0.2, -1.6, 1.2, -1.2, -1.57, 1.5], v=0)
    fast = rt.plan(rt.Phase(ur5, (0.1, 5.0), *ends, rt.Duration()), rt.Mesh(12))
    text = " ".join(str(fast).split())
    assert "doubt: wrist_3_joint accelerates with" in text and "times gravity at" in text
    limited = ur5.limits.with_(acceleration=15.0)
    slow = rt.plan(rt.Phase(ur5, (0.1, 5.0), *ends, rt.Duration(), limits=limited), rt.Mesh(12))
    assert "doubt" not in str(slow)


@pytest.mark.parametrize(("least", "doubt"), [(1.0, "takes 1 s, the least that duration= allows"), (0.1, "")])
def test_a_least_time_at_its_least_duration_is_doubted(least: float, doubt: str) -> None:
    """From rest to rest over 0.06 with |a| <= 1 takes 0.49 s."""
    block = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
    ends = rt.State([0, 0]), rt.State([0.06, 0])
    quick = rt.Phase(block, (least, 5.0), *ends, rt.Duration(), controls={"u": rt.between(-1, 1)})
    text = " ".join(str(rt.plan(quick, rt.Mesh(12))).split())
    assert doubt in text and ("doubt" in text) is bool(doubt)


def test_a_motion_that_nothing_limits_is_doubted() -> None:
    block = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    quick = rt.Phase(block, (0.0, 5.0), rt.State([0]), rt.State([1]), rt.Duration())
    assert "nothing limits its speed" in " ".join(str(rt.plan(quick, check=False)).split())
