"""Expressions without a finite value, such as the root of a negative number: which, where, and by which operation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.time_left import time_left
from robotraj.dynamics.variable import Variable
from robotraj.problem.phase import Phase
from robotraj.problem.phase_row import Kind
from robotraj.solution.phase_solution import PhaseSolution
from robotraj.solution.solution import Solution

OPERATIONS = {
    ca.OP_DIV: "{0:.6g} / {1:.6g}",
    ca.OP_INV: "1 / {0:.6g}",
    ca.OP_SQRT: "sqrt({0:.6g})",
    ca.OP_LOG: "log({0:.6g})",
    ca.OP_LOG1P: "log1p({0:.6g})",
    ca.OP_EXP: "exp({0:.6g})",
    ca.OP_POW: "{0:.6g} ** {1:.6g}",
    ca.OP_CONSTPOW: "{0:.6g} ** {1:.6g}",
    ca.OP_SQ: "{0:.6g} ** 2",
    ca.OP_ACOS: "acos({0:.6g})",
    ca.OP_ASIN: "asin({0:.6g})",
    ca.OP_TAN: "tan({0:.6g})",
    ca.OP_ATANH: "atanh({0:.6g})",
    ca.OP_ACOSH: "acosh({0:.6g})",
    ca.OP_MUL: "{0:.6g} * {1:.6g}",
    ca.OP_ADD: "{0:.6g} + {1:.6g}",
    ca.OP_SUB: "{0:.6g} - {1:.6g}",
}
"""Text of operations whose result may not be finite."""
SHOWN = 4
"""Variables that are shown with their values."""


def undefined_expression(solution: Solution) -> str:
    """Return a sentence on the first expression that is not finite along the iterate of a failed plan; else "".

    Equations, rows and objectives are evaluated at the collocation points, then their first derivatives. Derivatives
    of a robot's equations exist everywhere. Where the time of the plan is over, the first phase alone is checked.
    """
    for order in (0, 1):
        for part in solution.phases:
            sentence = _along(part, order) or _at_the_ends(part, order)
            if sentence or not time_left():
                return sentence
    return ""


def _along(part: PhaseSolution, order: int) -> str:
    """Check equations, rows and integrands at the points of a phase."""
    phase = part.phase
    times = np.unique(np.append(part.points, part.knots))
    sample = part.at(times)
    dae = phase.dae
    groups = ((sample.x, dae.states), (sample.z, dae.algebraic), (sample.u, dae.controls))
    columns = [np.reshape([named[v.name] for v in kind], (-1, len(times))) for named, kind in groups]
    p = np.array([part.parameters[name] for name in phase.parameter_names])
    if not np.all(np.isfinite(p)):
        return ""
    columns = [_filled(times, column) for column in columns]
    symbols = list(phase.rows.symbols)
    named = list(_expressions(phase, order))
    values = [times.reshape(1, -1), *columns, np.tile(p.reshape(-1, 1), len(times))]
    found = _evaluated([expression for _, expression in named], symbols, values, order)
    wrong = np.argwhere(~np.isfinite(found.T))
    if not wrong.size:
        return ""
    k, i = wrong[0]
    name, expression = named[int(i)]
    here = [value[:, k] for value in values]
    where = f"at t = {times[k]:.4g} s{_values(phase, expression, symbols, here)}"
    return _sentence(phase, name, expression, symbols, here, where, order)


def _filled(times: Array, rows: Array) -> Array:
    """Return values (n, m) at times (m,). Values that are not finite are interpolated from their neighbours."""
    filled = np.array(rows)
    for row in filled:
        known = np.isfinite(row)
        row[~known] = np.interp(times[~known], times[known], row[known]) if known.any() else 0.0
    return filled


def _at_the_ends(part: PhaseSolution, order: int) -> str:
    """Check the terms of the two ends of a phase."""
    phase = part.phase
    dae, names = phase.dae, phase.parameter_names
    x0, x1 = (ca.SX.sym(name, len(dae.states)) for name in ("start", "end"))
    t0, t1, p = ca.SX.sym("t0"), ca.SX.sym("t1"), ca.SX.sym("p", len(names))
    start, end = dae.point(t0, x0, None, None, p, names), dae.point(t1, x1, None, None, p, names)
    first, last = part.at(part.t0), part.at(part.t0 + part.duration)
    here = [np.array([sample.x[state.name] for state in dae.states]) for sample in (first, last)] + [
        np.array([part.t0])
    ]
    here += [np.array([part.t0 + part.duration]), np.array([part.parameters[name] for name in names])]
    if not all(np.all(np.isfinite(values)) for values in here):
        return ""
    symbols = [x0, x1, t0, t1, p]
    for _, term in phase.end_costs:
        expression = ca.SX(term.value(start, end))
        if not np.all(np.isfinite(_evaluated([expression], symbols, [v.reshape(-1, 1) for v in here], order))):
            name = f"objective term {type(term).__name__}"
            return _sentence(phase, name, expression, symbols, here, "at the ends", order)
    return ""


def _expressions(phase: Phase, order: int) -> Iterator[tuple[str, ca.SX]]:
    """Yield named scalar expressions in the symbols of the phase's table of rows."""
    table, point = phase.rows, phase.rows.point
    if not order or phase.robot is None:
        rates = ca.vertsplit(ca.SX(ca.vertcat(ca.SX(0, 1), phase.dae.rates(point))))
        yield from ((f"rate of {s.label!r}", rate) for s, rate in zip(phase.dae.states, rates, strict=True))
        residual = ca.vertsplit(ca.SX(ca.vertcat(ca.SX(0, 1), phase.dae.residual(point))))
        named = zip(phase.dae.residuals, residual, strict=False)
        yield from ((f"equation {variable.label!r}", value) for variable, value in named)
    # Rates are those of polynomials, and no expressions.
    rows = tuple(row for row in table if row.kind not in (Kind.BOUND, Kind.RATE))
    yield from zip((f"row {row.label!r}" for row in rows), table.expressions(rows), strict=True)
    for _, term in phase.integrals:
        yield f"objective term {type(term).__name__}", ca.SX(term.rate(point))


def _evaluated(expressions: Sequence[ca.SX], symbols: Sequence[ca.SX], values: Sequence[Array], order: int) -> Array:
    """Evaluate expressions (n,), or the sums of the entries of their gradients, at points (m,): (n, m)."""
    column = ca.densify(ca.vertcat(ca.SX(0, 1), *expressions))
    if order:
        # A sum is finite where all entries are; infinite entries of opposite signs give NaN.
        column = ca.densify(ca.sum2(ca.jacobian(column, ca.vertcat(*symbols))))
    function = ca.Function("expressions", list(symbols), [column])
    count = values[0].shape[1]
    return np.array(function.map(count)(*values)).reshape(column.numel(), count)


def _sentence(
    phase: Phase, name: str, expression: ca.SX, symbols: Sequence[ca.SX], here: Sequence[Array], where: str, order: int
) -> str:
    if order:
        return (
            f"the derivative of the {name} of phase {phase.name!r} is not finite {where}. Derivatives of roots and "
            "norms are infinite at zero: add a small constant inside, sqrt(1e-8 + ...)."
        )
    operation = _operation(ca.Function("expression", list(symbols), [expression]), here)
    what = f" in {operation}" if operation else ""
    return (
        f"the {name} of phase {phase.name!r} has no finite value{what} {where}. Change the expression, or bound the "
        "variables that it depends on."
    )


def _values(phase: Phase, expression: ca.SX, inputs: Sequence[ca.SX], values: Sequence[Array]) -> str:
    """List the variables that an expression reads, with their values."""
    dae = phase.dae
    groups: list[tuple[Variable, ...]] = [dae.states, dae.algebraic, dae.controls]
    shown = [
        f"{variable.name} = {values[1 + g][i]:.4g}"
        for g, variables in enumerate(groups)
        for i, variable in enumerate(variables)
        if ca.depends_on(expression, inputs[1 + g][i])
    ]
    return f", where {', '.join(shown[:SHOWN])}" if shown else ""


def _operation(function: ca.Function, values: Sequence[Array]) -> str:
    """Return the first operation on finite numbers whose result is not finite."""
    work = np.zeros(function.sz_w())
    for k in range(function.n_instructions()):
        code, out = function.instruction_id(k), function.instruction_output(k)
        inputs = function.instruction_input(k)
        if code == ca.OP_CONST:
            work[out[0]] = function.instruction_constant(k)
        elif code == ca.OP_INPUT:
            work[out[0]] = values[inputs[0]][inputs[1]]
        elif code == ca.OP_CALL:
            return ""
        elif code != ca.OP_OUTPUT:
            arguments = [work[i] for i in inputs]
            result = _applied(code, arguments)
            if not np.isfinite(result) and np.all(np.isfinite(arguments)):
                form = OPERATIONS.get(code, "operation on {0:.6g}")
                return form.format(*arguments)
            work[out[0]] = result
    return ""


def _applied(code: int, arguments: Sequence[float]) -> float:
    symbols = [ca.SX.sym(f"a{i}") for i in range(len(arguments))]
    applied = ca.SX.unary(code, symbols[0]) if len(symbols) == 1 else ca.SX.binary(code, *symbols)
    return float(ca.Function("operation", symbols, [applied])(*arguments))
