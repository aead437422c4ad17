"""What ``print(solution)`` shows."""

import numpy as np

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
