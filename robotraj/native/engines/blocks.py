"""Point functions for the compiled solver, evaluated by CasADi's functions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

import casadi as ca

from robotraj.native.build import load_native

if TYPE_CHECKING:
    from robotraj.native import PointBlock
    from robotraj.native.stage_tapes import Pattern, Tapes


class StageFunctions(Protocol):
    """What engines read of the functions of a stage; see ``transcription.assembly.point_functions``."""

    @property
    def v(self) -> ca.SX | ca.MX:
        """Unknowns."""

    @property
    def tapes(self) -> Tapes | None:
        """Tapes of the graph, None where it has none."""

    @property
    def costed(self) -> int | None:
        """Index of the output that is part of the objective."""

    @property
    def inputs(self) -> int:
        """Number of unknowns."""

    @property
    def outputs(self) -> int:
        """Number of outputs."""

    @property
    def function(self) -> ca.Function:
        """Outputs y(v, c)."""

    @property
    def jacobian(self) -> ca.Function:
        """Nonzeros of dy/dv."""

    @property
    def hessian(self) -> ca.Function:
        """Nonzeros of the Hessian of m' y."""

    @property
    def cost(self) -> ca.Function:
        """The costed output."""

    @property
    def gradient(self) -> ca.Function:
        """Its gradient."""

    @property
    def jacobian_pattern(self) -> Pattern:
        """Rows and columns of the Jacobian's nonzeros."""

    @property
    def hessian_pattern(self) -> Pattern:
        """Rows and columns of the Hessian's nonzeros."""


def wanted(stage: StageFunctions, costs: bool) -> dict[str, ca.Function]:
    """Return the functions of a stage by the name of their evaluation."""
    functions = {"values": stage.function}
    if stage.jacobian_pattern[0].size:
        functions["jacobian"] = stage.jacobian
    if stage.hessian_pattern[0].size:
        functions["hessian"] = stage.hessian
    if costs:
        functions |= {"cost": stage.cost, "gradient": stage.gradient}
    return functions


def casadi_block(
    stage: StageFunctions, count: int, costs: bool, batches: Mapping[str, tuple[ca.Function, int]]
) -> PointBlock:
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
