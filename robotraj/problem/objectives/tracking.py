"""Integral of the squared distance from a reference motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import field

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.errors import InputError, called
from robotraj._util.values import dataclass
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.expression_values import as_rows
from robotraj.dynamics.point import Point, RobotPoint, symbolic_model
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.dynamics.variable import Column, Scalar
from robotraj.problem.constraints.base import symbols_of
from robotraj.problem.objectives.base import Integral
from robotraj.problem.objectives.reference_motion import ReferenceSolution, symbolic_states
from robotraj.problem.objectives.weights import WeightsLike, weights_of
from robotraj.robot.robot import Robot


@dataclass(frozen=True)
class Tracking(Integral):
    """Weighted squared distance from a reference motion, integrated over the phase.

    Integral of sum w_q (q - q*)^2 + sum w_v (v - v*)^2 + sum w_F |p_F - p_F*|^2 + sum w_x (x - x*)^2.

    Parameters
    ----------
    reference : callable or Solution
        ``reference(t)`` of the global time t [s], a CasADi symbol, returns a mapping. It maps ``"q"`` and ``"v"`` to
        vectors (nq,) and (nv,), names of frames to positions (3,) [m], and names of a System's states to numbers. Only
        entries with a weight are needed. A Solution is constant before its start and after its end.
    q, v : number, sequence or mapping by joint
        Weights of positions [1/rad^2, 1/m^2] and velocities; q = 1 and v = 0 by default. For a floating root they
        weigh the quaternion's entries, for which a small angle e [rad] counts as e^2 / 4.
    frames : mapping of str to number
        Weights of frames' positions [1/m^2].
    states : None, number, sequence or mapping by state
        Weights of a System's states, 1 by default.
    """

    reference: Callable[[ca.SX], Mapping[str, ArrayLike | ca.SX]] | ReferenceSolution
    q: WeightsLike = None
    v: WeightsLike = 0.0
    frames: Mapping[str, float] = field(default_factory=dict)
    states: WeightsLike = None

    def rate(self, point: Point) -> Scalar:
        """Weighted squared distance at a point."""
        robot = point.robot if isinstance(point, RobotPoint) else None
        entries = self._robot_entries(point) if isinstance(point, RobotPoint) else self._system_entries(point)
        known = self._at(point.t, [name for name, *_ in entries], robot)
        total = ca.SX(0)
        for name, value, weights in entries:
            if name not in known:
                raise InputError(
                    f"Tracking: the reference returns no {name!r}, but its weight is not 0; return it or use 0."
                )
            wanted = as_rows(known[name], f"reference of {name!r}")
            if len(wanted) != len(weights):
                raise InputError(
                    f"Tracking: the reference of {name!r} has {len(wanted)} values; it must have {len(weights)}."
                )
            total += sum((w * (value[i] - wanted[i]) ** 2 for i, w in enumerate(weights) if w), ca.SX(0))
        return total

    def check(self, dynamics: Dynamics, parameters: Sequence[str]) -> None:
        """Check weights and frames, and the reference by calling it on symbols."""
        robot = isinstance(dynamics, RigidBody)
        if not callable(self.reference) and not hasattr(self.reference, "phases"):
            raise InputError("Tracking(reference): give a function of time that returns a mapping, or a Solution.")
        if robot and self.states is not None:
            raise InputError("Tracking: states= is for Systems; weigh a robot's motion with q=, v= and frames=.")
        if not robot and (self.q is not None or self.frames):
            raise InputError("Tracking: q= and frames= are for robots; weigh a System's states with states=.")
        rate = as_rows(self.rate(symbols_of(dynamics, parameters)), "Tracking rate")[0]
        if rate.is_zero():
            raise InputError("Tracking has only weights of 0; give one above 0.")

    def _robot_entries(self, point: RobotPoint) -> list[tuple[str, Column | Sequence[Scalar], list[float]]]:
        robot = point.robot
        q = (0.0 if self.frames or np.any(self._array(self.v)) else 1.0) if self.q is None else self.q
        entries = [
            ("q", point.q, weights_of(q, robot.position_names, "Tracking(q)")),
            ("v", point.v, weights_of(self.v, robot.velocity_names, "Tracking(v)")),
        ]
        for name, weight in self.frames.items():
            entries.append((name, point.frame(name).position, weights_of(weight, [name], "Tracking(frames)") * 3))
        return [entry for entry in entries if any(entry[2])]

    @staticmethod
    def _array(weights: WeightsLike) -> ArrayLike:
        return list(weights.values()) if isinstance(weights, Mapping) else np.ravel(0.0 if weights is None else weights)

    def _system_entries(self, point: Point) -> list[tuple[str, Column | Sequence[Scalar], list[float]]]:
        names = list(point.x)
        weights = weights_of(self.states, names, "Tracking(states)")
        return [(name, [point.x[name]], [w]) for name, w in zip(names, weights, strict=True) if w]

    def _at(self, t: ca.SX, names: Sequence[str], robot: Robot | None) -> Mapping[str, object]:
        if callable(self.reference):
            given = called("reference of Tracking", self.reference, t)
            if not isinstance(given, Mapping):
                raise InputError(
                    f"Tracking: the reference must return a mapping such as {{'q': [...]}}; got {type(given).__name__}."
                )
            return given
        if robot is None:
            return symbolic_states(self.reference, names, t)
        parts = {"q": [f"q.{name}" for name in robot.position_names]}
        if "v" in names:
            parts["v"] = [f"v.{name}" for name in robot.velocity_names]
        states = symbolic_states(self.reference, [column for columns in parts.values() for column in columns], t)
        known = {part: ca.vertcat(*(states[column] for column in columns)) for part, columns in parts.items()}
        placed = {f: symbolic_model(robot).frame_placement(f)(known["q"])[0] for f in names if f not in parts}
        return known | placed
