"""Rounded kinks of a share of the objective that its goal hardly sees.

A power |P| of small weight has a slack that is nearly free, which costs a solver variables and iterations however small
the weight is. Rounded, the objective is smaller by at most an error that is chosen here. An optimum of the rounded
objective is then within this error of the optimum, and a term of vanishing share changes nothing. The error follows
from the goal of the objective:

    error = PART goal J / T,   J and T of the plain motion (``sizes.shares``).

A kink of the share s, whose powers have the size P, is rounded within e = P PART goal / s. Its curvature is s J / (P e)
there. The curvature of smooth integrals of the share r is r J / P^2, and is exceeded where s^2 > r PART goal. From
there on, slacks are better. A least time has no curvature but that of its smoothing (``transcription.smoothness``).
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

from robotraj.fixed_mesh.sizes.shares import is_kinked, shares_of
from robotraj.problem.objectives.base import Integral, Sum
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.proof import Goals

PART = 0.1
"""Part of the goal of the objective that rounding may take, along the plain motion."""

_KNOWN: WeakKeyDictionary[Problem, dict[float, Problem]] = WeakKeyDictionary()


def with_soft_kinks(problem: Problem, goals: Goals, smoothing: float) -> Problem:
    """Return the problem with rounded kinks where their share is small, and otherwise itself."""
    allowed = PART * goals.objective
    if not any(is_kinked(phase.dae) for phase in problem.phases):
        return problem
    shares = shares_of(problem)
    curved = 1.0 - shares.kinks - shares.ends + smoothing * shares.ends
    if not shares.rate or shares.kinks**2 > allowed * curved:
        return problem
    known = _KNOWN.setdefault(problem, {})
    if allowed not in known:
        known[allowed] = Problem([_softened(phase, allowed * shares.rate) for phase in problem.phases], problem.links)
    return known[allowed]


def _softened(phase: Phase, error: float) -> Phase:
    """Return a phase whose objective is less by at most ``error`` a second."""
    assert phase.objective is not None
    count = sum(is_kinked(term.augment(phase.body)) for _, term in phase.integrals)
    terms = [
        (weight, term.softened(phase.body, error / abs(weight) / count))
        if weight and count and isinstance(term, Integral)
        else (weight, term)
        for weight, term in phase.objective.terms
    ]
    return phase.with_(objective=Sum(tuple(terms)))
