"""Point functions in the compiled module: several points at a time, and a robot's inverse dynamics by analysis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine, Mapped, StageMapped, VirtualMachine

if TYPE_CHECKING:
    from robotraj.native import PointBlock


@dataclass(frozen=True)
class Native(Engine):
    r"""Machine code that needs no compiler: any robot at once, the same numbers to rounding.

    Graphs of CasADi are run for eight, four or two points at a time, in the vectors of the processor (AVX-512, AVX2 or
    any, found when the module is loaded). Inverse dynamics of a robot are no graph at all: their values, their Jacobian
    and the Hessian of any combination :math:`\lambda'\tau` come from analytical formulas, at a cost that grows with
    the number of pairs of joints on one branch (``native/src/rigid_kernel.hpp``), and reach the point function by the
    chain rule. Functions that are no scalar graph (shooting), or call others (interpolants), stay with CasADi's virtual
    machine.

    Joints that neither turn about an axis nor slide along one, but for a free-flyer at the root, and models with
    unknown parameters (``rt.design.Design``) have their dynamics as a graph.

    Parameters
    ----------
    threads : int
        Threads that evaluate points side by side, made once for each plan; the bits are the same for any number.

    Examples
    --------
    >>> solution = rt.plan(phase, engine=rt.engines.Native())  # doctest: +SKIP
    """

    torques_apart: ClassVar[bool] = True

    threads: int = 1

    def __post_init__(self) -> None:
        if self.threads < 1:
            raise InputError(f"Native(threads) is a number of threads, 1 or more; got {self.threads}.")

    def block(self, stage: Any, count: int, costs: bool) -> PointBlock:
        """Give a stage as tapes, chained to its torques where it has any."""
        if stage.tapes is None:
            return VirtualMachine().block(stage, count, costs)
        block: PointBlock = stage.tapes.block(count, costs)
        return block

    def prepare(self, wanted: Sequence[Mapped | StageMapped]) -> list[ca.Function]:
        """Give functions that call the compiled module for all points at once; keep them alive while they are used."""
        costed = {
            id(each.stage) for each in wanted if isinstance(each, StageMapped) and each.name in ("cost", "gradient")
        }
        blocks: dict[tuple[int, int], PointBlock] = {}
        prepared = []
        for each in wanted:
            if not isinstance(each, StageMapped) or not isinstance(each.stage.v, ca.SX):
                prepared += VirtualMachine().prepare([each])
                continue
            key = id(each.stage), each.count
            if key not in blocks:
                blocks[key] = self.block(each.stage, each.count, id(each.stage) in costed)
            prepared.append(_Points(each.name, blocks[key], self.threads))
        return prepared


class _Points(ca.Callback):
    """One evaluation of a block as a function of dense columns."""

    def __init__(self, name: str, block: PointBlock, threads: int) -> None:
        ca.Callback.__init__(self)
        self._evaluate = getattr(block, "values" if name == "function" else name)
        self._threads, self._count = threads, block.count
        self._inputs = [block.inputs, block.constants] + [block.outputs] * (name == "hessian")
        outputs = {
            "function": block.outputs,
            "jacobian": block.jacobian_nonzeros,
            "hessian": block.hessian_nonzeros,
            "cost": 1,
            "gradient": block.inputs,
        }
        self._outputs = outputs[name]
        self.construct(name, {})

    def get_n_in(self) -> int:
        return len(self._inputs)

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self._inputs[i], self._count)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self._outputs, self._count)

    def has_eval_buffer(self) -> bool:
        return True

    def eval_buffer(self, arguments: Sequence[memoryview | None], results: Sequence[memoryview]) -> int:
        # What has no numbers is not handed over.
        given = [np.zeros(0) if argument is None else np.frombuffer(argument) for argument in arguments]
        np.frombuffer(results[0])[:] = self._evaluate(*given, threads=self._threads)
        return 0
