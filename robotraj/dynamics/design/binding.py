"""A design: the map from parameters of a phase to physical quantities of its robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol, cast

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.bodies import Bodies
from robotraj.dynamics.design.model import DesignedModel
from robotraj.dynamics.design.quantity import Quantity
from robotraj.dynamics.variable import Scalar

if TYPE_CHECKING:
    from robotraj.robot.robot import Robot
    from robotraj.symbolic import SymbolicModel


@dataclass(frozen=True, eq=False)
class Design(OneLine):
    """A robot whose masses, lengths, payloads, damping or gear ratios are parameters.

    Parameters
    ----------
    robot : Robot
    quantities : mapping of str to Quantity or sequence of Quantity
        By parameter: ``{"m": rt.design.BodyMass("forearm")}``; several quantities of one parameter share its value.

    Raises
    ------
    InputError
        A value is not a quantity, a body, frame or joint is unknown, or two parameters set one quantity.
    """

    robot: Robot
    quantities: Mapping[str, Quantity | Sequence[Quantity]]

    def __post_init__(self) -> None:
        taken: dict[tuple[object, ...], str] = {}
        for name, quantity in self.entries:
            if not isinstance(quantity, Quantity):
                raise InputError(
                    f"design= has {quantity!r} for parameter {name!r}; give a quantity of the robot: "
                    "rt.design.BodyMass('link'), rt.design.LinkLength('joint'), rt.design.Payload('frame'), "
                    "rt.design.JointDamping('joint'), rt.design.GearRatio('joint', 1e-5) or a list of them."
                )
            key = quantity.check(self.robot)
            if key and key in taken:
                raise InputError(f"Parameters {taken[key]!r} and {name!r} both set the {quantity.label}; keep one.")
            taken[key] = name

    @property
    def entries(self) -> tuple[tuple[str, Quantity], ...]:
        """Pairs of a parameter's name and a quantity."""
        return tuple(
            (name, quantity)
            for name, given in self.quantities.items()
            for quantity in (given if isinstance(given, list | tuple) else (given,))
        )

    def check(self, names: Sequence[str], lower: Iterable[float]) -> None:
        """Check that the phase has every parameter and that its bounds exclude impossible values.

        Raises
        ------
        InputError
            A parameter is missing, or its lower bound permits an impossible value.
        """
        bounds = dict(zip(names, lower, strict=True))
        for name, quantity in self.entries:
            if name not in bounds:
                raise unknown_name(
                    "parameter",
                    name,
                    names,
                    f"design= makes it the {quantity.label}; add it to parameters= with its bounds.",
                )
            quantity.check_lower(name, float(bounds[name]))

    def describe(self, name: str) -> tuple[str, str]:
        """Return the label of a parameter and its unit; both are empty if the design does not use it."""
        mine = [quantity for known, quantity in self.entries if known == name]
        return ", ".join(q.label for q in mine), mine[0].unit(self.robot) if mine else ""

    def bodies(self, values: Mapping[str, Scalar]) -> Bodies:
        """Return the bodies for values of the parameters, symbols or numbers."""
        bodies = Bodies(self.robot)
        for name, quantity in sorted(self.entries, key=lambda entry: entry[1].after_others):
            quantity.write(bodies, values[name])
        return bodies

    @cached_property
    def _parametric(self) -> SymbolicModel:
        from robotraj.symbolic import SymbolicModel  # imported on use: it loads the compiled module

        return SymbolicModel(self.robot.model, parametric=True)

    def model(self, bodies: Bodies) -> DesignedModel:
        """Return Pinocchio's algorithms for bodies that depend on symbols."""
        return DesignedModel(self._parametric, bodies)

    def realise(self, values: Mapping[str, float]) -> Robot:
        """Return a copy of the robot whose model has the quantities at given values of the parameters.

        Inertias, joint placements, frame placements, damping and armature change. Limits, names and shapes stay.
        """
        bodies = self.bodies({name: float(values[name]) for name, _ in self.entries})
        model = self.robot.model.copy()
        inertias, translations = np.array(ca.DM(bodies.inertias)), np.array(ca.DM(bodies.translations))
        for joint in range(1, model.njoints):
            own = self.robot.model.inertias[joint]
            if not np.array_equal(inertias[:, joint], own.toDynamicParameters()):
                model.inertias[joint] = pin.Inertia.FromDynamicParameters(inertias[:, joint])
            model.jointPlacements[joint].translation = translations[:, joint]
        for frame in bodies.moved_frames:
            origin = np.array(ca.DM(bodies.frame_translation(frame))).ravel()
            model.frames[frame].placement.translation = origin
        damping = np.array(ca.DM(bodies.damping)).ravel()
        if (added := bodies.added_armature) is not None:
            model.armature = model.armature + np.array(ca.DM(added)).ravel()
        return replace(self.robot, model=model, damping=damping)


class MovingPhase(Protocol):
    """A phase, and the robot that it moves, if any."""

    @property
    def robot(self) -> Robot | None:
        """The robot of the phase; None for a System."""


class PlannedRobot(Protocol):
    """A planned phase: what it moves, and the values of its parameters."""

    @property
    def phase(self) -> MovingPhase:
        """The phase that was planned."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values of the parameters by name."""


def realised(planned: PlannedRobot) -> Robot:
    """Return the robot of a planned phase with its design evaluated at ``planned.parameters``."""
    robot, design = planned.phase.robot, cast("Design | None", getattr(planned.phase, "bound_design", None))
    assert robot is not None, "a System moves no robot"
    return robot if design is None else design.realise(planned.parameters)
