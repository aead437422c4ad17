"""Limits of a robot's joints, from the model and the caller."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import cast

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.joint_limits.faults import fault_of, sentences
from robotraj.robot.joint_limits.values import PositionLimits, RateLimits, as_number, ends_for_all, pair_of
from robotraj.robot.loading.planning_model import independent_names
from robotraj.robot.root import ROOTS, root_of

UNLIMITED = 1e20
"""Magnitudes above represent no limit: Pinocchio writes 1.8e308, other tools 1e30."""

RATES = ("velocity", "acceleration", "jerk", "effort")
QUANTITIES = ("position", *RATES)
BOUNDS = tuple(f"{quantity}_{side}" for quantity in QUANTITIES for side in ("lower", "upper"))
"""Names of the arrays of ``Limits``."""


@dataclass(frozen=True, eq=False)
class Limits(OneLine):
    """Limits of every moving joint, lower and upper; infinite where there is none. The arrays are read-only.

    Attributes
    ----------
    joints : tuple of str
        Names of the entries of v: the root's velocities, where it moves, then the moving joints.
    position_lower, position_upper : (nv,) array
        Of q [rad, m].
    velocity_lower, velocity_upper : (nv,) array
        Of v [rad/s, m/s].
    acceleration_lower, acceleration_upper : (nv,) array
        Of a [rad/s^2, m/s^2].
    jerk_lower, jerk_upper : (nv,) array
        Of da/dt [rad/s^3, m/s^3].
    effort_lower, effort_upper : (nv,) array
        Of tau [N m, N].
    free : int
        Number of the root's entries, which are first. A limit for all joints does not apply to them. A floating root
        has six entries and no position limits.
    missing : tuple of str
        Joints for which the URDF states no position limits, though their type needs them.
    """

    joints: tuple[str, ...]
    position_lower: Array
    position_upper: Array
    velocity_lower: Array
    velocity_upper: Array
    acceleration_lower: Array
    acceleration_upper: Array
    jerk_lower: Array
    jerk_upper: Array
    effort_lower: Array
    effort_upper: Array
    free: int = 0
    missing: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", tuple(self.joints))
        object.__setattr__(self, "missing", tuple(self.missing))
        for name in BOUNDS:
            given = np.array(getattr(self, name), dtype=float).reshape(-1)
            if given.size != len(self.joints):
                raise InputError(f"Limits.{name} has {given.size} values; give one per joint, {len(self.joints)}.")
            beyond = np.abs(given) > UNLIMITED
            given[beyond] = np.copysign(np.inf, given[beyond])
            given.setflags(write=False)
            object.__setattr__(self, name, given)
        if self._floating and np.any(np.isfinite([self.position_lower[:6], self.position_upper[:6]])):
            raise InputError(
                "The limits bound positions of a floating root, which are no joint positions. Bound them by "
                "name, with rt.constraints.JointPosition({'root_z': rt.between(0.1, 0.5)})."
            )

    @classmethod
    def none(cls, joints: Iterable[str], free: int = 0) -> Limits:
        """Return limits that are all infinite; ``with_`` sets some."""
        names = tuple(joints)
        sides = {name: np.full(len(names), -np.inf if "lower" in name else np.inf) for name in BOUNDS}
        return cls(names, free=free, **sides)  # type: ignore[arg-type]  # names of arrays

    @property
    def positions(self) -> tuple[Array, Array]:
        """Lower and upper position limits by entries of q, (nq,) each [rad, m]."""
        if not self._floating:
            return self.position_lower, self.position_upper
        one = np.full(1, np.inf)
        return np.append(-one, self.position_lower), np.append(one, self.position_upper)

    @property
    def velocity(self) -> Array:
        """Limits (nv,) of abs(v) [rad/s, m/s]; an InputError where a joint's two limits differ in magnitude."""
        return self._magnitude("velocity")

    @property
    def acceleration(self) -> Array:
        """Limits (nv,) of abs(a) [rad/s^2, m/s^2]; an InputError where a joint's two limits differ in magnitude."""
        return self._magnitude("acceleration")

    @property
    def jerk(self) -> Array:
        """Limits (nv,) of abs(da/dt) [rad/s^3, m/s^3]; an InputError where a joint's two limits differ in magnitude."""
        return self._magnitude("jerk")

    @property
    def effort(self) -> Array:
        """Limits (nv,) of abs(tau) [N m, N]; an InputError where a joint's two limits differ in magnitude."""
        return self._magnitude("effort")

    def sides(self, quantity: str) -> tuple[Array, Array]:
        """Return the lower and the upper limits (nv,) of ``"position"``, ``"velocity"`` and so on."""
        if quantity not in QUANTITIES:
            raise unknown_name("limited quantity", quantity, QUANTITIES)
        return getattr(self, f"{quantity}_lower"), getattr(self, f"{quantity}_upper")

    def largest(self, quantity: str) -> Array:
        """Return the largest magnitude (nv,) that the limits of a quantity allow in either direction: its scale."""
        lower, upper = self.sides(quantity)
        return np.maximum(np.abs(lower), np.abs(upper))

    @property
    def _floating(self) -> bool:
        return self.free == len(ROOTS["floating"].velocities)

    @classmethod
    def of(cls, model: pin.Model, root: str = "fixed") -> Limits:
        """Copy the limits of a model whose joints, except the root, have one position and one velocity each.

        Pinocchio 4.1 writes lower limits of velocity with the wrong sign, and its sample models those of effort. A
        lower one above 0 that is no less than the upper one is read as the negative of that.
        """
        about = root_of(root)
        first, free = len(about.positions), len(about.velocities)
        found = cls.none((*about.velocities, *independent_names(model)[len(about.joints) :]), free)
        sides = {name: np.array(getattr(found, name)) for name in BOUNDS}
        sides["position_lower"][free:] = model.lowerPositionLimit[first:]
        sides["position_upper"][free:] = model.upperPositionLimit[first:]
        for quantity in ("velocity", "effort"):
            ends = (getattr(model, f"{side}{quantity.title()}Limit") for side in ("lower", "upper"))
            low, high = (np.array(end)[free:] for end in ends)
            sides[f"{quantity}_lower"][free:] = np.where((low >= high) & (low > 0.0), -high, low)
            sides[f"{quantity}_upper"][free:] = high
        return replace(found, **sides)  # type: ignore[arg-type]  # names of arrays

    def with_(
        self,
        position: PositionLimits | None = None,
        velocity: RateLimits | None = None,
        acceleration: RateLimits | None = None,
        effort: RateLimits | None = None,
        jerk: RateLimits | None = None,
    ) -> Limits:
        """Return a copy with some limits replaced.

        A number x stands for [-x, x]. One value for all joints leaves out the root, whose limits are set by name.

        Parameters
        ----------
        position : number, pair, between, mapping by joint, optional
            ``2.0`` for [-2, 2], ``(lower, upper)``, or ``{"elbow": (lower, upper)}`` [rad, m]; ``np.inf``
            and None: free.
        velocity, acceleration, effort, jerk : number, (nv,) array, between, mapping by joint, optional
            ``3.0`` for [-3, 3], an array of magnitudes, ``rt.between(lower, upper)``, or ``{"winch": (0, 30)}``
            [rad/s, m/s; rad/s^2, m/s^2; N m, N; rad/s^3, m/s^3]; ``np.inf`` lifts the limit.

        Raises
        ------
        InputError
            Unknown joints, NaN, negative magnitudes, a lower limit above its upper one, wrong sizes.

        Examples
        --------
        >>> robot.limits.with_(position={"elbow": (-1, 1)}, velocity=3.0, effort={"winch": (0, 30)})
        """
        given = {
            "position": position,
            "velocity": velocity,
            "acceleration": acceleration,
            "jerk": jerk,
            "effort": effort,
        }
        changed: dict[str, Array] = {}
        for quantity, value in given.items():
            if value is not None:
                lower, upper = self._changed(quantity, value)
                changed |= {f"{quantity}_lower": lower, f"{quantity}_upper": upper}
        stated = () if position is None else position if isinstance(position, Mapping) else self.joints
        missing = tuple(joint for joint in self.missing if joint not in stated)
        return replace(self, **changed, missing=missing)  # type: ignore[arg-type]  # names of arrays

    def scaled(self, rates: float = 1.0, **factors: float) -> Limits:
        """Return a copy with both sides of some limits multiplied.

        ``limits.scaled(velocity=0.5, effort=0.8)`` names them, ``limits.scaled(0.999)`` multiplies all but positions: a
        proof allows an excess of 1e-3, and such a plan keeps the limits of a controller that allows none.

        Raises
        ------
        InputError
            An unknown quantity, or a factor that is not above 0.
        """
        changed: dict[str, Array] = {}
        for quantity, factor in (dict.fromkeys(RATES, rates) | factors).items():
            if quantity not in QUANTITIES:
                raise unknown_name("limited quantity", quantity, QUANTITIES)
            if not as_number(f"factor of {quantity}", factor) > 0.0:
                raise InputError(f"The factor of {quantity} is {factor!r}; it must be above 0.")
            for name, side in zip(("lower", "upper"), self.sides(quantity), strict=True):
                changed[f"{quantity}_{name}"] = np.where(side == 0.0, 0.0, float(factor) * side)
        return replace(self, **changed)  # type: ignore[arg-type]  # names of arrays

    def override(self, changes: Limits | Mapping[str, PositionLimits | RateLimits]) -> Limits:
        """Return the limits after ``limits=`` of ``rt.load``: a mapping by quantity, see ``with_``, or Limits."""
        if isinstance(changes, Limits):
            if changes.joints != self.joints:
                raise InputError(
                    f"limits= is for joints {list(changes.joints)}, but the robot moves {list(self.joints)}."
                )
            return changes
        if not isinstance(changes, Mapping):
            raise InputError(
                f"limits= is a mapping such as {{'position': {{'elbow': (-1, 1)}}, 'velocity': 3.0}}; got {changes!r}."
            )
        for name in changes:
            if name not in QUANTITIES:
                raise unknown_name("limited quantity", name, QUANTITIES)
        return self.with_(**cast("dict[str, RateLimits]", dict(changes)))  # type: ignore[arg-type]  # checked above

    def warnings(self, actuated: Iterable[str] | None = None) -> tuple[str, ...]:
        """Return a sentence for each kind of limits that lock or contradict joints, with the remedy.

        Parameters
        ----------
        actuated : iterable of str, optional
            Joints with a motor (default: all); a joint without one may have an effort limit of 0.
        """
        rest = {joint: float(low) for joint, low in zip(self.joints, self.position_lower, strict=True)}
        return sentences(self.faults(actuated), rest)

    def faults(self, actuated: Iterable[str] | None = None) -> dict[str, dict[str, str]]:
        """Return the limits that lock or contradict a joint: a description by quantity, for each such joint."""
        motors = set(self.joints if actuated is None else actuated)
        sides = {quantity: self.sides(quantity) for quantity in QUANTITIES}
        found: dict[str, dict[str, str]] = {}
        for i, joint in enumerate(self.joints):
            for quantity, (lower, upper) in sides.items():
                if quantity == "effort" and joint not in motors:
                    continue
                fault = fault_of(quantity, float(lower[i]), float(upper[i]), joint in self.missing)
                if fault:
                    found.setdefault(joint, {})[quantity] = fault
        return found

    def _magnitude(self, quantity: str) -> Array:
        lower, upper = self.sides(quantity)
        for joint, low, high in zip(self.joints, lower, upper, strict=True):
            if low != -high and not (np.isnan(low) and np.isnan(high)):
                raise InputError(
                    f"The {quantity} limits of {joint!r} are [{low:g}, {high:g}], and no single number; read "
                    f"limits.{quantity}_lower and limits.{quantity}_upper."
                )
        return upper

    def _index(self, joint: object) -> int:
        if joint not in self.joints:
            raise unknown_name("moving joint", joint, self.joints)
        return self.joints.index(str(joint))

    def _changed(self, quantity: str, value: object) -> tuple[Array, Array]:
        """Return both sides of a quantity after a change."""
        lower, upper = (side.copy() for side in self.sides(quantity))
        if isinstance(value, Mapping):
            for joint, ends in value.items():
                i = self._index(joint)
                lower[i], upper[i] = pair_of(quantity, joint, ends)
            return lower, upper
        for i, ends in ends_for_all(quantity, value, self.joints, self.free):
            lower[i], upper[i] = pair_of(quantity, self.joints[i], ends)
        return lower, upper


def concatenated(joints: Iterable[str], parts: Iterable[Limits]) -> Limits:
    """Return the limits of several robots with fixed roots one after the other, for joints of these names."""
    every, names = list(parts), tuple(joints)
    before = [joint for part in every for joint in part.joints]
    missing = {joint for part in every for joint in part.missing}
    sides = {name: np.concatenate([getattr(part, name) for part in every]) for name in BOUNDS}
    unknown = tuple(name for name, joint in zip(names, before, strict=True) if joint in missing)
    return Limits(names, missing=unknown, **sides)  # type: ignore[arg-type]  # names of arrays
