"""One plan of many: without a watcher, alone or from the solution of a similar problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from inspect import Parameter, signature

from robotraj._util.errors import InputError, unknown_name
from robotraj.applications.many.options import GuessedChoices
from robotraj.planning.plan import plan
from robotraj.problem.problem import Problem
from robotraj.solution.records import with_effort_of
from robotraj.solution.solution import Solution
from robotraj.solvers.status import Status
from robotraj.transcription.reuse import sharing

OF_ONE = "check", "progress", "watch", "keep_program"
"""Options of ``rt.plan`` that are for a single plan."""


def planned(options: GuessedChoices, problem: Problem, *, keep_program: bool = False) -> Solution:
    """Plan one of many problems; a Ctrl-C ends all of them."""
    found = plan(problem, check=False, progress=False, keep_program=keep_program, **options)
    if found.status is Status.INTERRUPTED:
        # Workers ignore Ctrl-C, so it was pressed while this process planned.
        raise KeyboardInterrupt
    return found


def continued(options: GuessedChoices, problem: Problem, last: Solution) -> Solution:
    """Plan from the solution of the problem before, on its last mesh where that was proved.

    Where this fails, the plan begins on the first mesh of any plan.
    """
    if len(problem.phases) == len(last.phases):
        problem = replace(problem, phases=list(map(sharing, problem.phases, last.problem.phases)))
    from_last: GuessedChoices = {**options, "guess": last}
    proof, meshes = last.proof, [part.mesh for part in last.phases]
    if proof is None or not proof.holds or len(meshes) != len(problem.phases) or options.get("mesh") is not None:
        return planned(from_last, problem, keep_program=True)
    found = planned({**from_last, "mesh": meshes, "goals": proof.goals}, problem, keep_program=True)
    if found.success:
        return found
    return with_effort_of(found, planned(from_last, problem, keep_program=True))


def check_options(caller: str, options: Mapping[str, object], own: Callable[..., object]) -> None:
    """Refuse options that plans of many problems do not have, before a worker starts.

    Parameters
    ----------
    caller : str
        Its public name, for messages.
    options : mapping
        What it passes on to ``rt.plan``.
    own : callable
        The caller, whose own arguments a message names too.

    Raises
    ------
    InputError
        An option of ``rt.plan`` is for a single plan.
    UnknownName
        Naming the arguments of the caller and the options of ``rt.plan``.
    """
    known = [name for name in signature(plan).parameters if name not in ("problem", *OF_ONE)]
    named = [each.name for each in signature(own).parameters.values() if each.kind is not Parameter.VAR_KEYWORD]
    for name in options:
        if name in OF_ONE:
            raise InputError(
                f"{caller} keeps failed plans, shows no iterations and releases programs: leave {name}= out."
            )
        if name not in known:
            raise unknown_name(f"argument of {caller}", name, dict.fromkeys((*named, *known)))
