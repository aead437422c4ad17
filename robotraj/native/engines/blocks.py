"""Point functions for the compiled solver, evaluated by CasADi's functions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import casadi as ca

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native import PointBlock


def wanted(stage: Any, costs: bool) -> dict[str, ca.Function]:
    """Return the functions of a stage by the name of their evaluation."""
    functions = {"values": stage.function}
    if stage.jacobian_pattern[0].size:
        functions["jacobian"] = stage.jacobian
    if stage.hessian_pattern[0].size:
        functions["hessian"] = stage.hessian
    if costs:
        functions |= {"cost": stage.cost, "gradient": stage.gradient}
    return functions


def casadi_block(stage: Any, count: int, costs: bool, batches: Mapping[str, tuple[ca.Function, int]]) -> PointBlock:
    """Return the block of a stage at ``count`` points.

    Parameters
    ----------
    stage : PointFunctions
    count : int
    costs : bool
        Whether its costed output is part of the objective.
    batches : mapping
        For every name of ``wanted``, a function of several columns and the number of columns.
    """
    texts = {name: (f.serialize().encode("latin-1"), columns) for name, (f, columns) in batches.items()}
    return load_native().CasadiBlock(
        count,
        stage.inputs,
        stage.function.numel_in(1),
        stage.outputs,
        texts,
        stage.jacobian_pattern[0].size,
        stage.hessian_pattern[0].size,
        stage.costed if costs and stage.costed is not None else -1,
    )
