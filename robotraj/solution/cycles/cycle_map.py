"""The map from one period of a gait to the next.

A gait's closing link states its start x_0 as a function of its end x_T: x_0 = P x_T + d. P is a permutation with signs:
the identity, or left and right swapped. The next period continues where the last one ended if it follows
F(x) = P' (x - d), the one after it F(F(x)), and so on. Points and forces move with the root: p_0 = W p_T + e.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any, Protocol

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.design.binding import realised
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.problem.links.touchdown import Touchdown
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.robot.root import QUATERNION
from robotraj.solution.sample import Sample


class PhaseMotion(Protocol):
    """The planned motion of a phase."""

    @property
    def phase(self) -> Phase:
        """The phase that was planned."""

    @property
    def parameters(self) -> Mapping[str, float]:
        """Values of its parameters."""

    @property
    def knots(self) -> Array:
        """Ends of the intervals (K + 1,) [s]."""

    def at(self, t: float | Array) -> Sample[Any]:
        """Evaluate at times of the phase [s]."""


class PlannedCycle(Protocol):
    """A plan whose links may close it."""

    @property
    def problem(self) -> Problem:
        """The problem, with its phases and links."""

    @property
    def phases(self) -> Sequence[PhaseMotion]:
        """The motion of each phase."""


@dataclass(frozen=True, eq=False)
class CycleMap(OneLine):
    """The map q_0 = P q_T + d, v_0 = P_v v_T, p_0 = W p_T + e from the end of a gait to its start.

    Attributes
    ----------
    positions : ndarray (nq, nq)
        P.
    shift : ndarray (nq,)
        d [m, rad]; zero for a quaternion.
    velocities : ndarray (nv, nv)
        P_v.
    partners : mapping of str to str
        Joints and contacts, or their frames, that are swapped.
    world : ndarray (3, 3)
        W, diagonal: signs of the root's coordinates; a mirror of a robot without them swaps left and right, y.
    moved : ndarray (3,)
        e [m].
    """

    positions: Array
    shift: Array
    velocities: Array
    partners: Mapping[str, str] = field(default_factory=dict)
    world: Array = field(default_factory=lambda: np.eye(3))
    moved: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def mirrors(self) -> bool:
        """Whether left and right are swapped, so that two periods are one stride."""
        return not np.array_equal(self.velocities, np.eye(len(self.velocities)))

    def onwards(self, q: Array) -> Array:
        """Return positions (..., nq) one period later."""
        return np.asarray((q - self.shift) @ self.positions)

    def back(self, q: Array) -> Array:
        """Return positions (..., nq) one period earlier."""
        return np.asarray(q @ self.positions.T + self.shift)

    def points_onwards(self, points: Array) -> Array:
        """Return points (..., 3) of the world [m] one period later."""
        return np.asarray((points - self.moved) @ self.world)

    def forces_onwards(self, forces: Array) -> Array:
        """Return forces (..., 3), or with moments (..., 6), in world axes as they are a period later [N, N m].

        A moment m = r x f is transformed by det(W) W.
        """
        linear, angular = forces[..., :3] @ self.world, forces[..., 3:]
        if angular.shape[-1] == 0:
            return np.asarray(linear)
        return np.concatenate([linear, np.linalg.det(self.world) * (angular @ self.world)], axis=-1)

    def partner(self, *names: str) -> str:
        """Return the name of the partner a period later: a contact is found by its name, then by its frame."""
        return next((self.partners[name] for name in names if name in self.partners), names[0])


def cycle_map_of(solution: PlannedCycle) -> CycleMap | None:
    """Return the map of the link from the last phase to the first; None without such a link."""
    phases = solution.phases
    for link in solution.problem.links:
        if isinstance(link, Periodic | Mirror):
            repeat, first, last = link, link.first, link.last
        elif isinstance(link, Touchdown) and link.repeat is not None:
            repeat, first, last = link.repeat, link.second, link.first
        else:
            continue
        if first % len(phases) == 0 and last % len(phases) == len(phases) - 1 and phases[0].phase.robot is not None:
            return _read(repeat, phases[0], phases[-1])
    return None


def _read(repeat: Periodic | Mirror, opening: PhaseMotion, closing: PhaseMotion) -> CycleMap:
    """Write a repetition as matrices."""
    robot = realised(opening)
    nq, nv = robot.nq, robot.nv
    names = [state.name for state in opening.phase.body.states][: nq + nv]
    seen = repeat.of(closing.phase, names, type(repeat).__name__)
    matrix = np.zeros((nq + nv, nq + nv))
    for row, (source, sign) in enumerate(seen.sources[: nq + nv]):
        matrix[row, names.index(source)] = sign
    positions = matrix[:nq, :nq]
    start, end = opening.at(opening.knots[0]), closing.at(closing.knots[-1])
    shift = np.asarray(start.q, dtype=float).ravel() - positions @ np.asarray(end.q, dtype=float).ravel()
    fixed = np.equal(seen.lower[:nq], seen.upper[:nq])
    shift[fixed] = np.asarray(seen.lower[:nq])[fixed]
    if nq > nv:
        shift[QUATERNION] = 0.0
    world, moved = np.diag([1.0, -1.0 if isinstance(repeat, Mirror) else 1.0, 1.0]), np.zeros(3)
    for axis, name in enumerate(("q.root_x", "q.root_y", "q.root_z")):
        if name in names:
            row = names.index(name)
            world[axis, axis], moved[axis] = positions[row, row], shift[row]
    return CycleMap(positions, shift, matrix[nq:, nq:], seen.partners, world, moved)
