"""Conditions under which a setting is chosen, each with its text in the table of ``rt.plan``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from robotraj._util.values import dataclass
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.dynamics.system import SystemDynamics
from robotraj.fixed_mesh.sizes.shares import has_kinks, shares_of
from robotraj.native.engines.base import Engine
from robotraj.problem.augmentation import Augmented
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solvers.base import Solver
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh, MovingMesh
from robotraj.transcription.schemes.onestep import OneStep
from robotraj.transcription.schemes.shooting import Shooting


@dataclass(frozen=True, eq=False)
class Case:
    """A problem and the settings of its plan that are known so far.

    Attributes
    ----------
    problem : Problem
    settled : mapping of str to object
        Settings that the user gave or that were chosen before, by name.
    """

    problem: Problem
    settled: Mapping[str, object]

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """Known mesh, or meshes of the phases."""
        mesh = self.settled["mesh"]
        return (mesh,) if isinstance(mesh, Mesh) else tuple(mesh) if isinstance(mesh, Sequence) else ()


@dataclass(frozen=True, eq=False)
class Condition:
    """A condition on a case and its description.

    Attributes
    ----------
    text : str
    holds : callable
        From a Case to bool.
    """

    text: str
    holds: Callable[[Case], bool]


def any_phase(text: str, holds: Callable[[Phase], bool]) -> Condition:
    """Return the condition that at least one phase fulfils."""
    return Condition(text, lambda case: any(holds(phase) for phase in case.problem.phases))


def _needs_ipopt(case: Case) -> bool:
    engine = case.settled.get("engine")
    return isinstance(engine, Engine) and engine.made_for_ipopt


def _calls_native(case: Case) -> bool:
    solver = case.settled["solver"]
    return isinstance(solver, Solver) and solver.stagewise


def _has_narrow_stages(case: Case) -> bool:
    """Whether the solver works by stages with few variables each.

    Contacts, integral constraints, free roots, design parameters and few controls give a stage many variables. Schemes
    of one step have no stages.
    """
    widening = (_is_augmented, _integrates, _is_wide_robot, _is_wide_system)
    stepped = any(isinstance(scheme, OneStep) for mesh in case.meshes for scheme in mesh.given)
    return (
        _calls_native(case)
        and not stepped
        and not any(wide(phase) for phase in case.problem.phases for wide in widening)
    )


def _without_stages(case: Case) -> bool:
    return any(isinstance(m, MovingMesh) or isinstance(s, Shooting) for m in case.meshes for s in m.given)


def _is_augmented(phase: Phase) -> bool:
    """Whether variables are added to the equations of motion: by contacts, or by objectives that are not smooth."""
    body, dae = phase.body, phase.dae
    while isinstance(dae, Augmented) and dae.smooth:
        dae = dae.inner
    return dae is not body or bool(body.invariants)


def _integrates(phase: Phase) -> bool:
    return bool(phase.rows.integrals)


def _is_wide_robot(phase: Phase) -> bool:
    """Whether the root is free, the form is forward, a joint is continuous, or there are design parameters."""
    body = phase.body
    if not isinstance(body, InverseRigidBody):
        return phase.robot is not None
    return body.robot.root != "fixed" or body.design is not None or body.robot.nv != body.robot.nq


def _is_wide_system(phase: Phase) -> bool:
    """Whether a system has parameters or few controls."""
    body = phase.body
    if not isinstance(body, SystemDynamics):
        return not isinstance(body, InverseRigidBody)
    return bool(phase.parameter_names) or 2 * len(body.controls) < len(body.states)


def _follows_path(case: Case) -> bool:
    """Whether a phase is on a path, and robots on no path have a motor at every joint."""
    phases = case.problem.phases
    others = [phase for phase in phases if phase.path is None]
    return len(others) < len(phases) and all(is_exact(phase, (HermiteSimpson(),)) for phase in others)


def _is_arm(phase: Phase) -> bool:
    """Whether a robot on a fixed root has a motor at every joint, alone or in closed loops."""
    robot, contacts = phase.robot, phase.bound_contacts
    if not contacts:
        return is_exact(phase, (HermiteSimpson(),))
    fixed = robot is not None and robot.root == "fixed" and robot.nu == robot.nv
    return fixed and not any(contact.anchors for contact in contacts)


def _has_passive_joints(phase: Phase) -> bool:
    """Whether a robot on a fixed root has a joint without a motor, such as a cart-pole."""
    return phase.robot is not None and phase.robot.root == "fixed" and phase.robot.nu < phase.robot.nv


ALWAYS = Condition("otherwise", lambda case: True)
TOLERANCE = Condition("tolerance", lambda case: case.settled["tolerance"] is not None)
OPEN_MESH = Condition(
    "no mesh, no tolerance", lambda case: "mesh" not in case.settled and case.settled["tolerance"] is None
)
EXACT = Condition(
    "fully actuated",
    lambda case: all(is_exact(phase, (HermiteSimpson(),)) for phase in case.problem.phases),
)
ARMS = Condition("arms", lambda case: all(map(_is_arm, case.problem.phases)))
ON_PATH = Condition("a path", _follows_path)
STICKING = Condition("friction", lambda case: shares_of(case.problem).sticking)
PROVED = Condition("goals", lambda case: case.settled["goals"] is not None)
FOR_IPOPT = Condition("Compiled(), shooting or moving knots", lambda case: _needs_ipopt(case) or _without_stages(case))
KINKED = Condition("a kinked cost", lambda case: has_kinks(case.problem))
STAGEWISE = Condition("stages", _has_narrow_stages)
ROBOTS = Condition("robots", lambda case: all(phase.robot is not None for phase in case.problem.phases))
STAGES_OR_SYSTEM = Condition("stages or systems", lambda case: _has_narrow_stages(case) or not ROBOTS.holds(case))
FREE_RATES = Condition("free rates", lambda case: not any(phase.rows.rates for phase in case.problem.phases))
FREE_TIME = any_phase("free duration", lambda phase: phase.duration_bounds[0] < phase.duration_bounds[1])
CONTACTS = any_phase("contacts", lambda phase: bool(phase.bound_contacts))
PASSIVE = any_phase("joints without a motor", _has_passive_joints)
