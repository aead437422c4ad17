"""Problems for one-step schemes: explicit dynamics, one scheme a phase, no integral constraints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robotraj._util.errors import InputError
from robotraj.dynamics.rigid_body_forms import ForwardDynamics, InverseDynamics
from robotraj.problem.constraints.base import Where
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.schemes.shooting import Shooting, SingleShooting


def explicit(problem: Problem, meshes: Sequence[Mesh]) -> Problem:
    """Return the problem with forward dynamics of the robots whose phases have one-step schemes.

    Raises
    ------
    InputError
        A mesh mixes one-step schemes with others or moves the knots of single shooting. Or a phase has algebraic
        variables, an integral constraint, or an objective with slacks at collocation points.
    """
    phases = [
        _explicit(phase, mesh) if any(isinstance(scheme, OneStep) for scheme in mesh.schemes) else phase
        for phase, mesh in zip(problem.phases, meshes, strict=True)
    ]
    if all(new is old for new, old in zip(phases, problem.phases, strict=True)):
        return problem
    return Problem(phases, problem.links, problem.missing)


def _explicit(phase: Phase, mesh: Mesh) -> Phase:
    scheme = mesh.schemes[0]
    name = type(next(s for s in mesh.schemes if isinstance(s, OneStep))).__name__
    if any(other != scheme for other in mesh.schemes):
        raise InputError(
            f"The mesh of phase {phase.name!r} mixes {name} with other schemes; give all its intervals the same "
            "one, or split the motion into phases joined by rt.Continuity."
        )
    if isinstance(scheme, SingleShooting) and isinstance(mesh, MovingMesh):
        raise InputError(
            f"SingleShooting cannot move the knots of phase {phase.name!r}; use rt.schemes.MultipleShooting "
            f"with rt.schemes.MovingMesh."
        )
    if phase.robot is not None and isinstance(phase.dynamics, InverseDynamics):
        if phase.algebraic:
            raise InputError(
                f"{name} plans phase {phase.name!r} by forward dynamics, where accelerations are no variables to "
                "bound by algebraic=; use the constraint rt.constraints.JointAcceleration."
            )
        phase = replace(phase, dynamics=ForwardDynamics(phase.dynamics.softening))
    if phase.dae.algebraic:
        names = ", ".join(repr(variable.name) for variable in phase.dae.algebraic)
        raise InputError(
            f"{name} needs explicit dynamics, but phase {phase.name!r} has the algebraic variables {names}; use a "
            "collocation scheme such as rt.HermiteSimpson()."
        )
    if phase.rows.integrals:
        raise InputError(
            f"Phase {phase.name!r} bounds an integral, which {name} does not support; make the integral a state of the "
            "System, or use a collocation scheme such as rt.HermiteSimpson()."
        )
    if isinstance(scheme, Shooting) and any(row.where is Where.AT_NODES for row in phase.rows):
        raise InputError(
            f"The objective of phase {phase.name!r} has slacks at collocation points, which {name} does not have; use "
            "its smooth form, or a collocation scheme such as rt.HermiteSimpson()."
        )
    return phase
