"""Controls that are lines on every interval, where free ones in its middle lead finer meshes astray.

On a singular arc the free control in the middle of every interval alternates with those at the knots, and no finer mesh
ends that. Where a quadrature is exact only for small controls, as that of sqrt(1 + u^2), the program of a finer mesh
may have optima that no motion has.
"""

from __future__ import annotations

from dataclasses import replace

from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.schemes.collocation import Collocation
from robotraj.transcription.schemes.control import LinearControl
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

LINES = HermiteSimpson(control=LinearControl())
"""Hermite-Simpson with controls that are lines on every interval."""
HARDLY = 0.7
"""Ratio of the errors of successive meshes above which an error hardly falls: controls may alternate."""


def on_lines(problem: Problem, meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
    """Replace schemes of collocation by ``LINES`` where controls are unknowns of their own, but for contacts."""
    return tuple(
        replace(mesh, scheme=LINES) if _has_free_controls(phase, mesh) else mesh
        for phase, mesh in zip(problem.phases, meshes, strict=True)
    )


def _has_free_controls(phase: Phase, mesh: Mesh) -> bool:
    collocated = all(isinstance(scheme, Collocation) for scheme in mesh.given)
    return collocated and not phase.contacts and not is_exact(phase, mesh.given)
