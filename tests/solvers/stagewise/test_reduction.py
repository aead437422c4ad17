"""A program in stages is equivalent to the NLP: equal objective, rows and bounds, and exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import sparse

import robotraj as rt
from robotraj._util.arrays import Array
from robotraj.solvers.stagewise.program import StageProgram
from robotraj.solvers.stagewise.reduction import NotStagewise, Reduction, reduce
from robotraj.transcription.interval_limits.added_rows import with_added_rows
from robotraj.transcription.interval_limits.row_places import AddedRow
from tests.programs import nlp_of
from tests.solvers.stagewise.problems import EVERY

MESHES = {
    "HermiteSimpson": rt.Mesh(3, rt.HermiteSimpson()),
    "Trapezoidal": rt.Mesh(4, rt.schemes.Trapezoidal()),
    "Radau": rt.Mesh(3, rt.schemes.RadauIIA(3)),
    "Gauss": rt.Mesh(3, rt.schemes.GaussLegendre(2)),
    "Lobatto": rt.Mesh(2, rt.schemes.LobattoIIIA(4)),
}
PAIRS = [(p, m) for p in EVERY for m in MESHES if not (p == "step" and m == "Gauss")]
PLAIN, HULL = rt.interval_limits.ConstraintGeneration(), rt.interval_limits.BernsteinBounds(controls=True)
CASES = [
    *((p, m, PLAIN) for p, m in PAIRS),
    *((p, m, HULL) for p, m in PAIRS if p in ("hurried arm", "acrobot", "two phases", "step")),
]


def reduced(problem: str, mesh: str, interval_limits: rt.interval_limits.ConstraintGeneration = PLAIN) -> Reduction:
    return reduce(nlp_of(EVERY[problem](), MESHES[mesh], None, interval_limits))


def columns_of_states(program: StageProgram) -> NDArray[np.bool_]:
    """Return which entries of y are states, (n_y,)."""
    return np.concatenate([np.arange(u + x) >= u for u, x in zip(program.nu, program.nx, strict=True)])


@dataclass(frozen=True)
class Numbers:
    """The program evaluated with NumPy and CasADi's virtual machine."""

    reduction: Reduction

    def blocks(self, y: Array, which: str, *more: Array) -> list[Array]:
        found = []
        for part in self.reduction.program.blocks:
            block = part.block
            v = (block.gather @ y + part.shift).reshape(block.count, -1).T
            function = getattr(block.stage, which).map(block.count)
            found.append(np.array(function(v, block.constants, *(m.T for m in more))))
        return found

    def rows(self, y: Array) -> Array:
        program = self.reduction.program
        g = program.linear @ y + program.shift
        for part, values in zip(program.blocks, self.blocks(y, "function"), strict=True):
            g = g + part.block.scatter @ values.ravel(order="F")
        return g

    def objective(self, y: Array) -> float:
        program = self.reduction.program
        f = program.cost @ y + program.constant
        for part in program.blocks:
            if part.block.costs:
                (values,) = [v for p, v in zip(program.blocks, self.blocks(y, "function"), strict=True) if p is part]
                f += part.block.weights @ values[part.block.stage.costed]
        return float(f)

    def jacobian(self, y: Array) -> sparse.csr_array:
        program = self.reduction.program
        values = program.jacobian_constant.copy()
        for part, own in zip(program.blocks, self.blocks(y, "jacobian"), strict=True):
            values += part.jacobian @ own.ravel(order="F")
        shape = (program.linear.rows, y.size)
        jacobian = sparse.csr_array((values, program.jacobian), shape=shape)
        # The list omits x_{k+1}, whose coefficient in the dynamics is -1.
        dynamics = len(self.reduction.slots.carried)
        states = np.flatnonzero(columns_of_states(program))
        minus = sparse.csr_array((-np.ones(dynamics), (np.arange(dynamics), states)), shape=shape)
        return sparse.csr_array(jacobian + minus)

    def lagrangian(self, y: Array, multipliers: Array) -> float:
        return self.objective(y) + float(multipliers @ self.rows(y))

    def hessian(self, y: Array, multipliers: Array) -> Array:
        program = self.reduction.program
        values = np.zeros(program.hessian[0].size)
        for part in program.blocks:
            block = part.block
            m = (block.scatter.T @ multipliers).reshape(block.count, -1)
            if block.costs:
                m[:, block.stage.costed] += block.weights
            v = (block.gather @ y + part.shift).reshape(block.count, -1).T
            own = np.array(block.stage.hessian.map(block.count)(v, block.constants, m.T))
            values += part.hessian @ own.ravel(order="F")
        upper = sparse.csr_array((values, program.hessian), shape=(y.size, y.size)).toarray()
        return upper + np.triu(upper, 1).T


def consistent(reduction: Reduction, y: Array) -> Array:
    """Set the states of y to those of the dynamics."""
    slots, program = reduction.slots, reduction.program
    states = np.flatnonzero(columns_of_states(program))
    arriving = slots.carried[:, 0]
    for _ in range(len(program.nu)):
        y[states] = (slots.matrix @ y + slots.offset)[arriving]
    return y


def near(reduction: Reduction, durations: bool = True) -> Array:
    """A point near the guess; without ``durations`` at those of the guess, where a stretched motion is the motion."""
    y = reduction.start(reduction.nlp.guess)
    moved = 0.05 * np.random.default_rng(0).standard_normal(y.size)
    if reduction.stretched is not None and not durations:
        moved[np.isin(reduction.slots.variables, reduction.stretched.clock)] = 0.0
    return consistent(reduction, y + moved)


@pytest.mark.parametrize("durations", [False, True])
@pytest.mark.parametrize(("problem", "mesh", "interval_limits"), CASES)
def test_program_and_nlp_say_the_same(
    problem: str, mesh: str, interval_limits: rt.interval_limits.ConstraintGeneration, durations: bool
) -> None:
    reduction = reduced(problem, mesh, interval_limits)
    y, numbers, nlp = near(reduction, durations), Numbers(reduction), reduction.nlp
    w = reduction.columns(y)
    assert numbers.objective(y) == pytest.approx(nlp.objective(w), rel=1e-11, abs=1e-11)

    program, rows = reduction.program, numbers.rows(y)
    dynamics = len(reduction.slots.carried)
    np.testing.assert_allclose(rows[:dynamics], 0.0, atol=1e-12)
    # Every row and bound of the NLP has the distance from its bounds that it has in the program.
    lower = np.concatenate([np.zeros(rows.size - program.lower.size), program.lower])
    upper = np.concatenate([np.zeros(rows.size - program.upper.size), program.upper])
    ours = np.max(np.maximum(lower - rows, rows - upper), initial=0.0)
    values = nlp.values(w)
    broken = np.maximum(nlp.rows.lower - values, values - nlp.rows.upper) * nlp.row_scale
    outside = np.maximum(nlp.variables.lower - w, w - nlp.variables.upper) / nlp.scale
    theirs = max(np.max(broken, initial=0.0), np.max(outside, initial=0.0))
    if reduction.stretched is None or not durations:
        assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-9)
    else:
        # Stretched rows are multiplied by s, which is near 1 here.
        assert ours == pytest.approx(theirs, rel=0.3, abs=1e-9)


@pytest.mark.parametrize(("problem", "mesh", "interval_limits"), CASES)
def test_derivatives_by_differences(
    problem: str, mesh: str, interval_limits: rt.interval_limits.ConstraintGeneration
) -> None:
    reduction = reduced(problem, mesh, interval_limits)
    y, numbers = near(reduction), Numbers(reduction)
    rng = np.random.default_rng(1)
    multipliers = rng.standard_normal(reduction.program.linear.rows)
    # Along the dynamics, which are linear and hold from the first step on: a place that two stages read is evaluated in
    # one of them.
    direction = consistent(reduction, y + rng.standard_normal(y.size)) - y
    h = 1e-5
    ahead, behind = y + h * direction, y - h * direction
    slope = (numbers.rows(ahead) - numbers.rows(behind)) / (2 * h)
    jacobian = numbers.jacobian(y)
    np.testing.assert_allclose(jacobian @ direction, slope, rtol=1e-6, atol=1e-6 * max(1.0, abs(slope).max()))

    curve, h = numbers.hessian(y, multipliers), 1e-3
    values = [numbers.lagrangian(y + k * h * direction, multipliers) for k in range(-2, 3)]
    second = float(np.dot([-1, 16, -30, 16, -1], values)) / (12 * h**2)
    assert direction @ curve @ direction == pytest.approx(second, rel=1e-4, abs=1e-4 * max(1.0, abs(curve).max()))


def test_arm_needs_accelerations_alone() -> None:
    reduction = reduced("arm", "HermiteSimpson")
    program = reduction.program
    # x = (q, v, a) at the knot, u = (a in the middle, a at the next knot): no torque, no state inside.
    assert program.nx[1:].tolist() == [18, 18, 18]
    assert program.nu.tolist() == [18, 12, 12, 0]
    # Nothing but the goal is an equality.
    assert program.equalities.tolist() == [0, 0, 0, 12]


def test_torques_of_a_robot_that_lacks_a_motor_stay_unknowns() -> None:
    reduction = reduced("acrobot", "HermiteSimpson")
    assert not reduction.form.eliminated
    # u = (tau at the knot and in the middle, two a in the middle and at the next knot), at the last knot tau alone.
    assert reduction.program.nu.tolist()[1:] == [6, 6, 1]
    assert reduced("arm", "HermiteSimpson").form.eliminated


def test_free_duration_keeps_defects_linear() -> None:
    reduction = reduced("hurried arm", "HermiteSimpson")
    assert reduction.stretched is not None
    # One more state, the duration.
    assert reduction.program.nx[1:].tolist() == [19, 19, 19]
    assert reduction.program.equalities.tolist() == [0, 0, 0, 12]


def test_rates_of_torques_keep_defects_linear_at_a_free_duration() -> None:
    reduction = reduced("smooth arm", "HermiteSimpson")
    assert reduction.stretched is not None
    # States (q, v, tau, a, r) and the duration; a and r in the middle and at the next knot are controls. The torque
    # balances remain as equations.
    assert reduction.program.nx[1:-1].tolist() == [31, 31]
    assert reduction.program.nu[1:-1].tolist() == [24, 24]
    assert reduction.program.equalities[1:-1].tolist() == [12, 12]


def test_jerks_keep_defects_linear_at_a_free_duration() -> None:
    reduction = reduced("jerky arm", "HermiteSimpson")
    assert reduction.stretched is not None
    # States (q, v, A, a, j) and the duration; torques are eliminated, and a = A is left as equations.
    assert reduction.program.nx[1:-1].tolist() == [31, 31]
    assert reduction.program.nu[1:-1].tolist() == [24, 24]
    assert reduction.program.equalities[1:-1].tolist() == [12, 12]


@pytest.mark.parametrize("mesh", MESHES)
def test_rows_on_torques_between_the_points_keep_torques_eliminated(mesh: str) -> None:
    plain, hull = (reduced("hurried arm", mesh, interval_limits).program for interval_limits in (PLAIN, HULL))
    assert hull.nu.tolist() == plain.nu.tolist()
    assert hull.nx.tolist() == plain.nx.tolist()
    assert hull.equalities.tolist() == plain.equalities.tolist()


def test_shooting_is_refused() -> None:
    nlp = nlp_of(EVERY["pendulum"](), rt.Mesh(4, rt.schemes.MultipleShooting()))
    with pytest.raises(NotStagewise, match="MultipleShooting"):
        reduce(nlp)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("duration", [2.0, (1.0, 3.0)])
def test_an_added_row_of_a_path_constraint_stays_in_its_interval(
    mesh: str, duration: float | tuple[float, float]
) -> None:
    """Otherwise the states that it depends on would be carried from the first stage on, for all added rows at once."""
    system = rt.System(["x", "y", "v"], ["a", "w"], lambda point: [point.x["v"], point.u["w"], point.u["a"]])
    away = rt.PathConstraint(lambda point: point.x["x"] ** 2 + point.x["y"] ** 2, lower=0.1, name="away")
    ends = rt.State([-1, 0, 0]), rt.State([1, 1, 0])
    objective = rt.Lagrange(lambda point: point.u["a"] ** 2 + point.u["w"] ** 2)
    plain = nlp_of(rt.Problem([rt.Phase(system, duration, *ends, objective, [away])]), MESHES[mesh])
    last = MESHES[mesh].count - 1
    nlp = with_added_rows(plain, [AddedRow(0, k, 0, 0.4) for k in range(last + 1)], plain.guess)
    reduction, without = reduce(nlp), reduce(plain)
    added = np.arange(len(plain.variables), len(nlp.variables)).reshape(last + 1, 3)
    assert reduction.slots.first[added].tolist() == [[k] * 3 for k in range(last + 1)]
    assert np.array_equal(reduction.slots.last[added], reduction.slots.first[added])
    assert reduction.program.nx.max() == without.program.nx.max()

    numbers, w = Numbers(reduction), nlp.guess + 0.1 * np.random.default_rng(0).normal(size=len(nlp.guess))
    y = reduction.start(w)
    assert numbers.objective(y) == pytest.approx(nlp.objective(reduction.columns(y)))
