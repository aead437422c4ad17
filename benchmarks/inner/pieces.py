"""The inner pieces of a plan, by name: what ``pytest-benchmark`` times and ``instructions.py`` counts.

A piece is made once, which does everything that it needs, and called many times; every call does the same work.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Any

import numpy as np

import robotraj as rt
from robotraj.fixed_mesh.between.nlp_violations import violations
from robotraj.solvers.stagewise.reduction import reduce
from robotraj.transcription.extract import extract
from robotraj.transcription.interval_limits.added_rows import with_added_rows
from robotraj.transcription.interval_limits.interval_violations import state_violations
from robotraj.transcription.interval_limits.row_places import AddedRow
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.transcribe import transcribe

Call = Callable[[], Any]

ENDS = {
    "ur5": ((-1.1, -1.8, 1.6, -1.2, -1.57, 0.0), (1.1, -0.8, 0.6, -0.6, -0.6, 1.2)),
    "panda": ((0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785), (1.5, 0.5, -0.5, -1.2, 0.6, 2.2, -0.8)),
}
"""First and last configuration of tasks T4 and T5; fingers stay closed."""


@dataclass(frozen=True)
class Piece:
    """One piece.

    Attributes
    ----------
    group, name : str
    make : callable
        Prepares it; gives what is called.
    """

    group: str
    name: str
    make: Callable[[], Call]


@lru_cache(maxsize=8)
def robot(name: str) -> rt.Robot:
    fingers = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0} if name == "panda" else None
    return rt.load(name, locked=fingers)


def phase(name: str) -> rt.Phase:
    start, end = (rt.State(q=list(q), v=0) for q in ENDS[name])
    duration: Any = 1.0 if name == "ur5" else (0.3, 3.0)
    return rt.Phase(robot(name), duration, start, end, rt.Effort() if name == "ur5" else rt.Duration())


@lru_cache(maxsize=8)
def nlp(name: str, intervals: int, engine: rt.engines.Native | None = None) -> Nlp:
    return transcribe(
        rt.Problem([phase(name)]), rt.Mesh(intervals, rt.HermiteSimpson()), rt.guess.StraightLine(), engine=engine
    )


def loading(name: str) -> Call:
    return partial(rt.load, name)


def posing(name: str) -> Call:
    robot(name)
    return partial(phase, name)


def transcribing(name: str, intervals: int, engine: rt.engines.Native | None = None) -> Call:
    # A phase keeps what was differentiated for it: every call has a new one.
    return lambda: transcribe(
        rt.Problem([phase(name)]), rt.Mesh(intervals, rt.HermiteSimpson()), rt.guess.StraightLine(), engine=engine
    )


def assembling(name: str, intervals: int) -> Call:
    known = nlp(name, intervals)
    # A copy has made no functions yet; the stage's derivatives are there.
    return lambda: with_added_rows(known, [], known.guess).functions


def reducing(name: str, intervals: int) -> Call:
    known = nlp(name, intervals, rt.engines.Native())
    return lambda: reduce(known)


def point_function(name: str, intervals: int, which: str) -> Call:
    """One function of the stage at all places, by CasADi's virtual machine, one thread."""
    known = nlp(name, intervals)
    (block,) = (b for b in known.blocks if b.count > 1)
    arguments = [block.places(known.guess), block.constants]
    if which == "hessian":
        arguments.append(np.ones((block.stage.outputs, block.count)))
    function = getattr(block.stage, which)
    result = np.empty((block.count, int(function.numel_out(0))))
    buffer, run = function.map(block.count).buffer()
    columns = [np.ascontiguousarray(argument.T) for argument in arguments]
    for i, column in enumerate(columns):
        buffer.set_arg(i, column.data)
    buffer.set_res(0, result.data)

    def call(*_: object) -> np.ndarray:
        run()
        return result

    return partial(call, buffer, columns)  # CasADi reads and writes arrays that must exist as long


def native_function(name: str, intervals: int, which: str) -> Call:
    """Make the same of the compiled module: inverse dynamics by analysis, one thread."""
    known = nlp(name, intervals, rt.engines.Native())
    (block,) = (b for b in known.blocks if b.count > 1)
    compiled = rt.engines.Native().block(block.stage, block.count, block.costs)
    arguments = [np.ascontiguousarray(each.T).ravel() for each in (block.places(known.guess), block.constants)]
    if which == "hessian":
        arguments.append(np.ones(block.stage.outputs * block.count))
    function = getattr(compiled, which)
    return lambda: function(*arguments)


def checking(name: str, intervals: int) -> Call:
    known = nlp(name, intervals)
    return lambda: violations(known, known.guess, np.inf)


def extracting(name: str, intervals: int) -> Call:
    known = nlp(name, intervals)
    return lambda: extract(known, known.guess)


def looking(name: str, intervals: int) -> Call:
    known = nlp(name, intervals)
    (trajectory,) = extract(known, known.guess)
    return lambda: state_violations(known.problem.phases[0], 0, trajectory, np.inf)


def adding_rows(name: str, intervals: int) -> Call:
    known = nlp(name, intervals)
    number = known.problem.phases[0].rows.of_state[-1].number
    added = [AddedRow(0, k, number, 0.25) for k in range(0, intervals, 5)]
    return lambda: with_added_rows(known, added, known.guess)


ARMS = ("ur5", "panda")
FUNCTIONS = ("function", "jacobian", "hessian")
COMPILED = ("values", "jacobian", "hessian")

PIECES = (
    *(Piece("loading", f"load {name}", partial(loading, name)) for name in ARMS),
    *(Piece("loading", f"phase of {name}", partial(posing, name)) for name in ARMS),
    *(
        Piece("point functions", f"{which} of {name}, 101 places", partial(point_function, name, 50, which))
        for name in ARMS
        for which in FUNCTIONS
    ),
    *(
        Piece(
            "point functions",
            f"{which} of {name}, 101 places, rt.engines.Native()",
            partial(native_function, name, 50, which),
        )
        for name in ARMS
        for which in COMPILED
    ),
    *(Piece("transcription", f"transcribe ur5, N = {n}", partial(transcribing, "ur5", n)) for n in (50, 200)),
    Piece(
        "transcription",
        "transcribe ur5, N = 50, rt.engines.Native()",
        partial(transcribing, "ur5", 50, rt.engines.Native()),
    ),
    Piece("transcription", "functions for IPOPT of ur5, N = 50", partial(assembling, "ur5", 50)),
    Piece("transcription", "added rows of ur5, N = 50", partial(adding_rows, "ur5", 50)),
    *(Piece("reduction", f"reduce ur5, N = {n}", partial(reducing, "ur5", n)) for n in (50, 200)),
    Piece("checks", "every row of ur5, N = 50", partial(checking, "ur5", 50)),
    Piece("checks", "polynomials of ur5, N = 50", partial(extracting, "ur5", 50)),
    Piece("checks", "between the points of ur5, N = 50", partial(looking, "ur5", 50)),
)
