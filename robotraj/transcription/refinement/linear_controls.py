"""Controls that are lines on every interval, where free ones in its middle lead finer meshes astray.

On a singular arc the free control in the middle of every interval alternates with those at the knots, and no finer mesh
ends that. Where a quadrature is exact only for small controls, as that of sqrt(1 + u^2), the program of a finer mesh
may have optima that no motion has.
"""

from __future__ import annotations

from dataclasses import replace

from robotraj.problem.problem import Problem
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.schemes.control import LinearControl
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh

LINES = HermiteSimpson(control=LinearControl())
"""Hermite-Simpson with controls that are lines on every interval."""


def with_linear_controls(problem: Problem, meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
    """Replace Hermite-Simpson by ``LINES`` in phases whose controls are unknowns of their own."""
    return tuple(
        mesh if is_exact(phase, mesh.given) else replace(mesh, scheme=_linear(mesh.given))
        for phase, mesh in zip(problem.phases, meshes, strict=True)
    )


def on_lines(problem: Problem, meshes: tuple[Mesh, ...]) -> tuple[Mesh, ...]:
    """Replace every scheme of collocation by ``LINES`` in phases whose controls are unknowns of their own."""
    return tuple(
        replace(mesh, scheme=LINES)
        if all(isinstance(scheme, Collocation) for scheme in mesh.given) and not is_exact(phase, mesh.given)
        else mesh
        for phase, mesh in zip(problem.phases, meshes, strict=True)
    )


def _linear(schemes: tuple[Scheme, ...]) -> Scheme | tuple[Scheme, ...]:
    replaced = tuple(LINES if scheme == HermiteSimpson() else scheme for scheme in schemes)
    return replaced if len(replaced) > 1 else replaced[0]
