"""Limits of a robot's joints, from the model and the caller."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol, TypeAlias, cast

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.loading.planning_model import names_of
from robotraj.robot.root import ROOTS, root_of

Array = npt.NDArray[np.float64]

UNLIMITED = 1e20
"""Magnitudes above represent no limit: Pinocchio writes 1.8e308, other tools 1e30."""

MAGNITUDES = ("velocity", "acceleration", "effort")
QUANTITIES = ("position", *MAGNITUDES)


class Interval(Protocol):
    """An object with lower and upper bounds, such as ``rt.between`` returns."""

    @property
    def lower(self) -> float | None:
        """Lower bound."""

    @property
    def upper(self) -> float | None:
        """Upper bound."""


Ends: TypeAlias = "float | Sequence[float | None] | Interval"
"""Position limits of one joint: x for [-x, x], a pair, or an object with ``lower`` and ``upper``."""
PositionLimits: TypeAlias = "Ends | Mapping[str, Ends]"
MagnitudeLimits: TypeAlias = "npt.ArrayLike | Mapping[str, float]"


@dataclass(frozen=True, eq=False)
class Limits(OneLine):
    """Limits of every moving joint; infinite where there is none. The arrays are read-only.

    Attributes
    ----------
    joints : tuple of str
        Names of the entries of v: the root's velocities, where it moves, then the moving joints.
    position_lower, position_upper : (nv,) array
        q_lower <= q <= q_upper [rad, m].
    velocity : (nv,) array
        abs(v) <= velocity [rad/s, m/s].
    acceleration : (nv,) array
        abs(a) <= acceleration [rad/s^2, m/s^2]; a URDF has none.
    effort : (nv,) array
        abs(tau) <= effort [N m, N].
    free : int
        Number of the root's entries, which are first. A limit for all joints does not apply to them. A floating root
        has six entries and no position limits.
    """

    joints: tuple[str, ...]
    position_lower: Array
    position_upper: Array
    velocity: Array
    acceleration: Array
    effort: Array
    free: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "joints", tuple(self.joints))
        for name in ("position_lower", "position_upper", *MAGNITUDES):
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

    @property
    def positions(self) -> tuple[Array, Array]:
        """Lower and upper position limits by entries of q, (nq,) each [rad, m]."""
        if not self._floating:
            return self.position_lower, self.position_upper
        one = np.full(1, np.inf)
        return np.append(-one, self.position_lower), np.append(one, self.position_upper)

    @property
    def _floating(self) -> bool:
        return self.free == len(ROOTS["floating"].velocities)

    @classmethod
    def of(cls, model: pin.Model, root: str = "fixed") -> Limits:
        """Copy the limits of a model whose joints, except the root, have one position and one velocity each.

        If a model's lower velocity or effort limit is tighter than the upper one, it applies in both
        directions. Pinocchio 4.1 writes lower velocity limits with the wrong sign; a lower limit that is not
        negative is ignored.
        """
        about = root_of(root)
        first, free = len(about.positions), len(about.velocities)
        unlimited = np.full(model.nv, np.inf)
        lower, upper, velocity, effort = -unlimited, unlimited.copy(), unlimited.copy(), unlimited.copy()
        lower[free:], upper[free:] = model.lowerPositionLimit[first:], model.upperPositionLimit[first:]
        velocity[free:] = _magnitude(model.lowerVelocityLimit, model.upperVelocityLimit)[free:]
        effort[free:] = _magnitude(model.lowerEffortLimit, model.upperEffortLimit)[free:]
        joints = (*about.velocities, *names_of(model)[1 + len(about.joints) :])
        return cls(joints, lower, upper, velocity, unlimited, effort, free)

    def with_(
        self,
        position: PositionLimits | None = None,
        velocity: MagnitudeLimits | None = None,
        acceleration: MagnitudeLimits | None = None,
        effort: MagnitudeLimits | None = None,
    ) -> Limits:
        """Return a copy with some limits replaced.

        A number or a pair applies to all joints except the root, whose limits are set by name.

        Parameters
        ----------
        position : number, pair, mapping by joint, optional
            ``2.0`` for [-2, 2], ``(lower, upper)``, or ``{"elbow": (lower, upper)}`` [rad, m]; ``np.inf``
            and None: free.
        velocity, acceleration, effort : number, (nv,) array, mapping by joint, optional
            Largest magnitude [rad/s, m/s; rad/s^2, m/s^2; N m, N]; ``np.inf`` lifts the limit.

        Raises
        ------
        InputError
            Unknown joints, NaN, negative magnitudes, a lower limit above its upper one, wrong sizes.

        Examples
        --------
        >>> robot.limits.with_(position={"elbow": (-1, 1)}, velocity=3.0)
        """
        lower, upper = (self.position_lower, self.position_upper) if position is None else self._positions(position)
        return replace(
            self,
            position_lower=lower,
            position_upper=upper,
            velocity=self._magnitudes("velocity", velocity),
            acceleration=self._magnitudes("acceleration", acceleration),
            effort=self._magnitudes("effort", effort),
        )

    def override(self, changes: Limits | Mapping[str, PositionLimits | MagnitudeLimits]) -> Limits:
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
        velocity, acceleration, effort = (cast("MagnitudeLimits | None", changes.get(name)) for name in MAGNITUDES)
        return self.with_(cast("PositionLimits | None", changes.get("position")), velocity, acceleration, effort)

    def warnings(self, actuated: Iterable[str] | None = None) -> tuple[str, ...]:
        """Return a sentence for each joint that its limits lock or contradict, with the remedy.

        Parameters
        ----------
        actuated : iterable of str, optional
            Joints with a motor (default: all); a joint without one may have an effort limit of 0.
        """
        sentences = []
        for joint, faults in self.faults(actuated).items():
            cures = ", ".join(f"'{name}': {{{joint!r}: {_EXAMPLE[name]}}}" for name in faults)
            sentences.append(
                f"Joint {joint!r} cannot be planned with its limits: {', '.join(faults.values())}. Give others "
                f"with rt.load(..., limits={{{cures}}}) or Phase(limits=robot.limits.with_(...)), or none with "
                "Phase(limits=None)."
            )
        return tuple(sentences)

    def faults(self, actuated: Iterable[str] | None = None) -> dict[str, dict[str, str]]:
        """Return the limits that lock or contradict a joint: a description by quantity, for each such joint."""
        motors = set(self.joints if actuated is None else actuated)
        found = {joint: self._faults(i, joint in motors) for i, joint in enumerate(self.joints)}
        return {joint: faults for joint, faults in found.items() if faults}

    def _faults(self, i: int, motor: bool) -> dict[str, str]:
        faults: dict[str, str] = {}
        low, high = self.position_lower[i], self.position_upper[i]
        if np.isnan(low) or np.isnan(high):
            faults["position"] = f"position limits [{low:g}, {high:g}] are not numbers"
        elif low > high:
            faults["position"] = f"position limits [{low:g}, {high:g}] are inverted"
        elif low == high:
            faults["position"] = f"position limits [{low:g}, {high:g}] lock it"
        for name in MAGNITUDES:
            value = getattr(self, name)[i]
            if name == "effort" and not motor:
                continue
            if np.isnan(value) or value < 0:
                faults[name] = f"{name} limit {value:g} is no magnitude"
            elif value == 0:
                faults[name] = f"{name} limit 0 locks it"
        return faults

    def _index(self, joint: object) -> int:
        if joint not in self.joints:
            raise unknown_name("moving joint", joint, self.joints)
        return self.joints.index(str(joint))

    def _positions(self, value: PositionLimits) -> tuple[Array, Array]:
        lower, upper = self.position_lower.copy(), self.position_upper.copy()
        if not isinstance(value, Mapping):
            value = {joint: value for joint in self.joints[self.free :]}
        for joint, pair in value.items():
            i = self._index(joint)
            lower[i], upper[i] = _pair(joint, pair)
        return lower, upper

    def _magnitudes(self, name: str, value: MagnitudeLimits | None) -> Array:
        magnitudes = np.array(getattr(self, name))
        if value is None:
            return magnitudes
        if isinstance(value, Mapping):
            for joint, magnitude in value.items():
                magnitudes[self._index(joint)] = _number(f"{name} limit of {joint!r}", magnitude)
        else:
            try:
                given = np.asarray(value, dtype=float).reshape(-1)
            except (TypeError, ValueError) as error:
                raise InputError(f"The {name} limit is no number: {value!r}.") from error
            if given.size not in (1, len(self.joints)):
                raise InputError(
                    f"The {name} limit has {given.size} values; give 1 or {len(self.joints)}, "
                    f"in the order {', '.join(self.joints)}."
                )
            if given.size == 1:
                magnitudes[self.free :] = given
            else:
                magnitudes[:] = given
        for joint, magnitude in zip(self.joints, magnitudes, strict=True):
            if np.isnan(magnitude) or magnitude < 0:
                raise InputError(
                    f"The {name} limit of {joint!r} is {magnitude:g}; it is a magnitude and must be positive."
                )
        return magnitudes


_EXAMPLE = {"position": "(lower, upper)", **dict.fromkeys(MAGNITUDES, "largest")}


def _magnitude(lower: Array, upper: Array) -> Array:
    return np.where((lower < 0) & (-lower < upper), -lower, upper)


def _number(what: str, value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]  # a TypeError becomes an InputError
    except (TypeError, ValueError) as error:
        raise InputError(f"The {what} is no number: {value!r}.") from error


def _pair(joint: object, value: object) -> tuple[float, float]:
    """Read ``Ends``: 2.0, (lower, upper) or an object with ``lower`` and ``upper``, such as ``rt.between`` makes."""
    ends: Sequence[object]
    if not isinstance(value, str) and hasattr(value, "lower") and hasattr(value, "upper"):
        ends = (value.lower, value.upper)
    elif np.ndim(cast("npt.ArrayLike", value)) == 0:
        size = _number(f"position limit of {joint!r}", value)
        ends = (-size, size)
    else:
        ends = cast("Sequence[object]", value)
    if len(ends) != 2:
        raise InputError(f"The position limits of {joint!r} are a pair (lower, upper); got {value!r}.")
    low = -np.inf if ends[0] is None else _number(f"lower position limit of {joint!r}", ends[0])
    high = np.inf if ends[1] is None else _number(f"upper position limit of {joint!r}", ends[1])
    if not low <= high:
        raise InputError(
            f"The position limits of {joint!r} are [{low:g}, {high:g}]: the lower must be below the upper."
        )
    return low, high
