"""The block of a stage function whose derivatives are CasADi's graphs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import casadi as ca
import numpy as np

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native._native import Recipe, TapeBlock


class StageFunctions(Protocol):
    """What of a stage a block is made of; see ``transcription.stage``."""

    inputs: int
    costed: int | None
    function: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    cost: ca.Function
    gradient: ca.Function


def tape_block(stage: StageFunctions, count: int, costs: bool) -> TapeBlock:
    """Run the scalar graphs of a stage, a pack of points at a time.

    Parameters
    ----------
    stage : Stage
        Of SX.
    count : int
        Points.
    costs : bool
        Whether its costed output is part of the objective.
    """
    costs = costs and stage.costed is not None
    block: TapeBlock = load_native().TapeBlock(
        count,
        stage.inputs,
        int(stage.function.numel_in(1)),
        _recipe(stage.function),
        _recipe(stage.jacobian),
        _recipe(stage.hessian),
        _recipe(stage.cost) if costs else None,
        _recipe(stage.gradient) if costs else None,
        stage.costed if costs else -1,
    )
    return block


def _recipe(function: ca.Function) -> Recipe:
    none: Any = np.zeros(0, dtype=np.int64)
    text = function.serialize().encode("latin-1")
    recipe: Recipe = load_native().Recipe(
        tape=text,
        jacobian=False,
        hessian=False,
        made=0,
        result=1,
        results=int(function.numel_out(0)),
        out=none,
        left=none,
        right=none,
    )
    return recipe
