"""Pinocchio's algorithms with the symbols of a design in place of the model's inertias and lengths."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import casadi as ca

if TYPE_CHECKING:
    from robotraj.dynamics.design.bodies import Bodies
    from robotraj.symbolic import SymbolicModel

Call = Callable[..., ca.SX]

EXPRESSIONS = (
    "forward_dynamics",
    "inverse_dynamics",
    "mass_matrix",
    "nonlinear_effects",
    "gravity",
    "kinetic_energy",
    "potential_energy",
    "center_of_mass",
    "centroidal_momentum",
)


class DesignedModel:
    """A ``SymbolicModel`` whose inertias and lengths are those of a design.

    Each attribute is a function with the inputs and outputs of the ``SymbolicModel``'s function of the same name. The
    outputs are expressions of the inputs and of the parameters in the bodies.

    Parameters
    ----------
    symbolic : SymbolicModel
        Functions of the robot's model, with inertias and translations as inputs.
    bodies : Bodies
    """

    def __init__(self, symbolic: SymbolicModel, bodies: Bodies) -> None:
        self._symbolic = symbolic
        self._inputs = ca.SX(bodies.inertias), ca.SX(bodies.translations)
        self._armature = bodies.added_armature
        model = bodies.robot.model
        self._shifts = {
            model.frames[i].name: (
                ca.DM(model.frames[i].placement.rotation),
                bodies.frame_translation(i) - ca.DM(model.frames[i].placement.translation),
            )
            for i in bodies.moved_frames
        }

    @property
    def mass(self) -> ca.SX:
        """Mass of all moving bodies [kg]."""
        return ca.sum2(self._inputs[0][0, 1:])

    def __getattr__(self, name: str) -> Call:
        if name not in EXPRESSIONS:
            raise AttributeError(name)
        function = self._with_design(getattr(self._symbolic, name))
        return function if self._armature is None else self._with_armature(name, function)

    def _with_armature(self, name: str, function: Call) -> Call:
        """Return a function with the added armature A: tau + A a, M + diag(A), T + v' A v / 2."""
        added = self._armature
        if name == "inverse_dynamics":
            return lambda q, v, a, *more: function(q, v, a, *more) + added * a
        if name == "mass_matrix":
            return lambda q: function(q) + ca.diag(added)
        if name == "kinetic_energy":
            return lambda q, v: function(q, v) + 0.5 * ca.dot(v, added * v)
        if name == "forward_dynamics":
            # (M + A) a = M a0, in which a0 is the acceleration without it.
            mass = self._with_design(self._symbolic.mass_matrix)
            return lambda q, *more: ca.solve(mass(q) + ca.diag(added), ca.mtimes(mass(q), function(q, *more)))
        return function

    def frame_placement(self, frame: str) -> Call:
        """``(q) -> (position, rotation)`` of the frame in world axes."""
        placement = self._with_design(self._symbolic.frame_placement(frame))
        if frame not in self._shifts:
            return placement

        def shifted(q: ca.SX) -> tuple[ca.SX, ca.SX]:
            position, rotation = placement(q)
            return position + self._shift(frame, rotation), rotation

        return shifted

    def frame_velocity(self, frame: str) -> Call:
        """``(q, v) -> (velocity)``: linear then angular, local-world-aligned. A shift d of the frame adds w x d."""
        velocity = self._with_design(self._symbolic.frame_velocity(frame))
        if frame not in self._shifts:
            return velocity

        def shifted(q: ca.SX, v: ca.SX) -> ca.SX:
            motion, d = velocity(q, v), self._world_shift(frame, q)
            return ca.vertcat(motion[:3] + ca.cross(motion[3:], d), motion[3:])

        return shifted

    def frame_acceleration(self, frame: str) -> Call:
        """``(q, v, a) -> (acceleration)``: classical. A shift d adds dw/dt x d + w x (w x d)."""
        acceleration = self._with_design(self._symbolic.frame_acceleration(frame))
        if frame not in self._shifts:
            return acceleration
        velocity = self._with_design(self._symbolic.frame_velocity(frame))

        def shifted(q: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
            motion, turning, d = acceleration(q, v, a), velocity(q, v)[3:], self._world_shift(frame, q)
            linear = motion[:3] + ca.cross(motion[3:], d) + ca.cross(turning, ca.cross(turning, d))
            return ca.vertcat(linear, motion[3:])

        return shifted

    def frame_jacobian(self, frame: str) -> Call:
        """``(q) -> (J)``: 6 x nv, local-world-aligned. A shift d adds -[d]x times the angular rows."""
        jacobian = self._with_design(self._symbolic.frame_jacobian(frame))
        if frame not in self._shifts:
            return jacobian

        def shifted(q: ca.SX) -> ca.SX:
            j, d = jacobian(q), self._world_shift(frame, q)
            return ca.vertcat(j[:3, :] - ca.mtimes(ca.skew(d), j[3:, :]), j[3:, :])

        return shifted

    def _with_design(self, function: ca.Function) -> Call:
        return lambda *arguments: function(*arguments, *self._inputs)

    def _shift(self, frame: str, rotation: ca.SX) -> ca.SX:
        """Displacement of the frame from the model to the design, in world axes (3,) [m]."""
        on_joint, shift = self._shifts[frame]
        return ca.mtimes([rotation, on_joint.T, shift])

    def _world_shift(self, frame: str, q: ca.SX) -> ca.SX:
        return self._shift(frame, self._with_design(self._symbolic.frame_placement(frame))(q)[1])
