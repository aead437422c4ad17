"""Settings of solves of the relaxed problem: few intervals, one solver, and no limits between the points."""

from __future__ import annotations

from dataclasses import replace

from robotraj.native.engines.native import Native
from robotraj.problem.problem import Problem
from robotraj.solution.settings import Restarts, Settings
from robotraj.solvers.interior_point import InteriorPoint
from robotraj.transcription.interval_limits.methods import ConstraintGeneration
from robotraj.transcription.schemes.lobatto import HermiteSimpson, LobattoIIIA
from robotraj.transcription.schemes.mesh import Mesh

COARSE, COARSE_STEP, FINER = 15, 6, 12
"""Intervals of a phase: without and with contacts, and by Lobatto IIIA with four points."""
PATIENCE, BRIEFLY = 700, 200
"""Largest number of iterations of a solve, and of one with contacts or limits of rates.

Many motions may need the same relaxation, such as those under a limit of the tool's speed. Solves then take hundreds.
With contacts an iteration takes longer. Limits of rates are not relaxed, so that there may be no solution.
"""


def coarse_settings(problem: Problem, settings: Settings, finer: bool = False) -> Settings:
    """Return settings with few intervals, or with ``finer`` ones of a higher order."""
    contacts = any(phase.contacts for phase in problem.phases)
    rates = any(phase.rows.rates for phase in problem.phases)
    coarse = Mesh(COARSE_STEP if contacts else COARSE, HermiteSimpson())
    return replace(
        settings,
        mesh=Mesh(FINER, LobattoIIIA(4)) if finer else coarse,
        solver=InteriorPoint(max_iterations=BRIEFLY if contacts or rates else PATIENCE, fallback=None),
        engine=Native(),
        interval_limits=ConstraintGeneration(rounds=0),
        restarts=Restarts(0),
    )
