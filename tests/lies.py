"""Solutions whose samples, models or figures were changed after planning."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import robotraj as rt
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj.dynamics.variable import Named
from robotraj.solution.phase_solution import PhaseSolution

Array = Any
Change = Callable[[Array, Array], Array]
"""A function of the times (m,) and the values (m, n)."""


@dataclass(frozen=True, eq=False)
class Liar(PhaseSolution):
    """A phase whose samples are changed: functions of (t, values) by field: tau, q, v, x, u, forces."""

    changes: tuple[tuple[str, Change], ...] = ()

    def at(self, t: Any, interval: Any = None) -> Any:
        sample = super().at(t, interval=interval)
        lies = dict(self.changes)
        times = np.asarray(sample.t)
        changed: dict[str, Any] = {}
        for name in ("q", "v"):
            if name in lies:
                changed[name] = lies[name](times[..., None], getattr(sample, name))
        if "tau" in lies:
            tau = lies["tau"](times[..., None], sample.tau)
            changed["tau"] = tau
            others = list(sample.u.values())[tau.shape[-1] :]
            changed["u"] = Named("control", list(sample.u), [*np.moveaxis(tau, -1, 0), *others])
        for kind in ("x", "u"):
            if kind in lies:
                named = getattr(sample, kind)
                changed[kind] = Named(kind, list(named), [lies[kind](times, np.asarray(named[n])) for n in named])
        if "forces" in lies:
            for kind in ("z", "forces"):
                named = getattr(sample, kind)
                own = [lies["forces"](times, np.asarray(v)) if not n.startswith("a.") else v for n, v in named.items()]
                changed[kind] = Named(kind, list(named), own)
        return replace(sample, **changed)


def lying(solution: rt.Solution, **changes: Change) -> rt.Solution:
    """Change the samples of all phases."""
    told = tuple(changes.items())
    return replace(solution, phases=tuple(Liar(p.phase, p.mesh, p.trajectory, told) for p in solution.phases))


def stored(solution: rt.Solution, which: str, change: Callable[[Array], Array]) -> rt.Solution:
    """Change the values (k, n) that every interval stores of ``"x"``, ``"z"`` or ``"u"``."""

    def other(part: PhaseSolution) -> PhaseSolution:
        kept = getattr(part.trajectory, which)
        values = PiecewisePolynomial(kept.breaks, kept.sites, [change(np.asarray(each)) for each in kept.values])
        return PhaseSolution(part.phase, part.mesh, replace(part.trajectory, **{which: values}))

    return replace(solution, phases=tuple(map(other, solution.phases)))


def fed_back(solution: rt.Solution, factors: Sequence[float]) -> rt.Solution:
    """Multiply the gains of every motor by its factor, as a file may hold them."""
    known = solution.gains
    scale = np.asarray(factors, dtype=float)[:, None]
    told = replace(solution)
    told.__dict__["gains"] = replace(
        known, phases=tuple(replace(phase, matrices=scale * phase.matrices) for phase in known.phases)
    )
    return told


def elsewhere(solution: rt.Solution, change: Callable[[rt.Phase], rt.Phase]) -> rt.Solution:
    """Pretend that the plan answers other phases: another model, limit, end or obstacle."""
    phases = [change(p.phase) for p in solution.phases]
    parts = tuple(PhaseSolution(new, p.mesh, p.trajectory) for new, p in zip(phases, solution.phases, strict=True))
    return replace(solution, phases=parts, problem=rt.Problem(phases, list(solution.problem.links)))


def spliced(solution: rt.Solution, other: rt.Solution, phase: int) -> rt.Solution:
    """Exchange one phase for that of another plan, which is a motion by itself."""
    parts = list(solution.phases)
    parts[phase] = other.phases[phase]
    return replace(solution, phases=tuple(parts))


def linked(solution: rt.Solution, *links: rt.Link) -> rt.Solution:
    """Pretend that the phases were joined by other links."""
    return replace(solution, problem=rt.Problem(list(solution.problem.phases), list(links)))


def with_model(phase: rt.Phase, change: Callable[[pin.Model], None]) -> rt.Phase:
    """Return a phase of a robot whose Pinocchio model was changed."""
    model = phase.robot.model.copy()
    change(model)
    return replace(phase, subject=replace(phase.robot, model=model))


URDF = """<robot name="axis"><link name="base"/><link name="body"><inertial><mass value="{mass}"/>
<inertia ixx="{mass}" iyy="{mass}" izz="{mass}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="body"/><axis xyz="{axis}"/>
<limit lower="-{travel}" upper="{travel}" velocity="{speed}" effort="{effort}"/>{dynamics}</joint></robot>"""

FINGER = (
    '<link name="{0}"><inertial><mass value="0.1"/>'
    '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="{0}_joint" type="prismatic"><parent link="arm"/><child link="{0}"/><origin xyz="0 0 0.4"/>'
    '<axis xyz="0 {1} 0"/><limit lower="0" upper="0.04" velocity="0.2" effort="20"/>{2}</joint>'
)
GRIPPER = (
    '<robot name="gripper"><link name="base"/><link name="arm"><inertial><origin xyz="0 0 0.2"/><mass value="2"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="lift" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
    '<limit lower="-3" upper="3" velocity="5" effort="50"/></joint>'
    + FINGER.format("left", "1", "")
    + FINGER.format("right", "-1", '<mimic joint="left_joint"/>')
    + "</robot>"
)


def axis(folder: Path, **values: Any) -> rt.Robot:
    """Return a mass on a slide."""
    file = folder / f"axis_{abs(hash(tuple(values.items())))}.urdf"
    file.write_text(
        URDF.format(**{"axis": "1 0 0", "speed": 100, "effort": 1e6, "travel": 100, "dynamics": ""} | values)
    )
    return rt.load(str(file))
