"""Point functions in the compiled module: several points at a time, with analytical derivatives of inverse dynamics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import casadi as ca
import numpy as np

from robotraj._util.checks import is_whole
from robotraj._util.errors import InputError
from robotraj._util.values import dataclass
from robotraj.native.engines.base import Engine, Mapped, StageMapped, VirtualMachine
from robotraj.native.engines.blocks import StageFunctions

if TYPE_CHECKING:
    from robotraj.native import PointBlock


@dataclass(frozen=True)
class Native(Engine):
    r"""The compiled module, which needs no compiler at run time.

    CasADi's graphs are evaluated at eight, four or two points at a time in the vector registers of the processor.
    AVX-512, AVX2 or SSE2 is detected when the module is loaded. A robot's inverse dynamics, their Jacobian and the
    Hessian of :math:`\lambda'\tau` are evaluated by analytical formulas (``native/src/rigid_body/rigid_kernel.hpp``).
    The cost grows with the number of pairs of joints on a common branch. The chain rule combines both. CasADi's virtual
    machine evaluates functions that are no scalar graph (shooting) or call other functions (interpolants).

    The dynamics are a graph where a joint is neither revolute, prismatic nor a free-flyer at the root. They are one as
    well where the model has unknown parameters (``rt.design.Design``).

    Parameters
    ----------
    threads : int
        Threads that evaluate points in parallel; results are bitwise equal for any number.

    Examples
    --------
    >>> solution = rt.plan(phase, engine=rt.engines.Native())  # doctest: +SKIP
    """

    separate_torques: ClassVar[bool] = True

    threads: int = 1

    def __post_init__(self) -> None:
        if not (is_whole(self.threads) and self.threads >= 1):
            raise InputError(f"Native(threads) is a number of threads, 1 or more; got {self.threads!r}.")

    def block(self, stage: StageFunctions, count: int, costs: bool) -> PointBlock:
        """Return the block of a stage from its tapes, with the chain rule of its torques."""
        if stage.tapes is None:
            return VirtualMachine().block(stage, count, costs)
        block: PointBlock = stage.tapes.block(count, costs)
        return block

    def prepare(self, wanted: Sequence[Mapped | StageMapped]) -> list[ca.Function]:
        """Return functions that call the compiled module for all points; the caller keeps them alive."""
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
        # CasADi passes None for empty arguments.
        given = [np.zeros(0) if argument is None else np.frombuffer(argument) for argument in arguments]
        np.frombuffer(results[0])[:] = self._evaluate(*given, threads=self._threads)
        return 0
