"""Reuse of a transcription for a problem that differs only in its ends, or for another guess."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robotraj.guess.base import InitialGuess
from robotraj.native.engines.base import Engine
from robotraj.transcription.collocation.index_reduction import determined_at_ends
from robotraj.transcription.collocation.invariants import determined_invariants
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.transcribe import bounds_of, start_of

if TYPE_CHECKING:
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem
    from robotraj.transcription.layout import PhaseLayout

Array = NDArray[np.float64]


def transcribed_again(
    nlp: Nlp,
    problem: Problem,
    mesh: Mesh | Sequence[Mesh],
    engine: Engine | None,
    interval_limits: ConstraintGeneration,
    w: Array,
) -> Nlp | None:
    """Return an NLP with the ends of another problem: bounds and the start of the solver change.

    Parameters
    ----------
    nlp : Nlp
        NLP of a problem whose phases differ from those of ``problem`` by ``with_(start=..., end=...)`` at most.
    problem : Problem
    mesh, engine, interval_limits
        See ``transcribe``.
    w : ndarray (n_w,)
        Start of the solver, in physical units.

    Returns
    -------
    Nlp or None
        An NLP with the blocks, scales and functions of ``nlp``; None where more than the ends differs.
    """
    before = nlp.problem
    meshes = [mesh] * len(problem.phases) if isinstance(mesh, Mesh) else list(mesh)
    alike = (
        len(before.phases) == len(problem.phases) == len(meshes)
        and tuple(before.links) == tuple(problem.links)
        and (engine is None or engine == nlp.engine)
        and interval_limits == nlp.interval_limits
        and all(_alike(*each) for each in zip(before.phases, problem.phases, nlp.layouts, strict=True))
        and all(layout.mesh == own for layout, own in zip(nlp.layouts, meshes, strict=True))
        and not any(isinstance(m, MovingMesh) or isinstance(s, OneStep) for m in meshes for s in m.given)
        and len(nlp.free) == len(w)
    )
    if not alike:
        return None
    bounds = bounds_of(problem, nlp.layouts, interval_limits)
    variables = nlp.free.bounded(bounds)
    guess = np.clip(w, variables.lower, variables.upper)
    rows = nlp.loose_rows or nlp.rows
    again = replace(nlp, problem=problem, variables=variables, guess=guess, rows=rows, loose_rows=None)
    return _with_functions(again, nlp)


def started_at(nlp: Nlp, guess: InitialGuess) -> Nlp:
    """Return the NLP with another start; blocks, scales and functions are those of ``nlp``."""
    return continued_at(nlp, start_of(nlp.problem, nlp.layouts, nlp.link_columns, nlp.variables, guess))


def continued_at(nlp: Nlp, w: Array) -> Nlp:
    """Return the NLP with the start w (n_w,) in physical units; blocks, scales and functions are those of ``nlp``."""
    return _with_functions(replace(nlp, guess=w), nlp)


def _with_functions(again: Nlp, nlp: Nlp) -> Nlp:
    """Copy the assembled functions, whose preparation was counted in the first plan."""
    if "functions" in nlp.__dict__:
        again.__dict__["functions"] = replace(nlp.functions, preparing=0.0)
    return again


def _alike(before: Phase, now: Phase, layout: PhaseLayout) -> bool:
    """Whether two phases share everything but their ends, as ``Phase.with_`` returns them."""
    if before is now:
        return True
    same = before.dae is now.dae and before.rows is now.rows
    if not same or before.duration_bounds != now.duration_bounds:
        return False
    # The ends determine which rows impose an invariant, or an equality with its rates.
    pairs = zip(determined_invariants(before), determined_invariants(now), strict=True)
    invariants = all(np.array_equal(one, other) for one, other in pairs)
    return invariants and determined_at_ends(before, layout) == determined_at_ends(now, layout)
