"""Contact forces along a planned motion, if its torques drive the robot and its contacts hold.

Under given q, v and tau the equations of motion and those of the contacts determine accelerations and forces,

    M a + h = B tau - d(v) + J' f,    J a + dJ/dt v = 0.

At collocation points both are the planned ones. Between them a planned acceleration moves the contacts a little. The
force that stops this motion is the larger the heavier the robot is at its feet. Redundant rows do not determine their
forces, which are then as planned.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.phase import Phase
from robotraj.robot.tangent import normalised
from robotraj.transcription.driven_motion import Inputs, MotionEquations
from robotraj.transcription.extract import PhaseTrajectory

REDUNDANT = 1e-5
"""Singular values of J below this share of the largest belong to redundant rows: plans have errors of that size."""


@dataclass(frozen=True, eq=False)
class HeldForces(OneLine):
    """Algebraic variables z and controls u along a motion whose contacts hold, for ``inputs`` that move them a little.

    The phase moves a robot by inverse dynamics, with contacts that are constraints.
    """

    phase: Phase
    trajectory: PhaseTrajectory
    inputs: Inputs

    def at(self, t: Array, interval: int | NDArray[np.int_] | None = None) -> tuple[Array, Array]:
        """Evaluate at times (m,), each on its own interval where these are given."""
        times = np.atleast_1d(t)
        z, u = self.inputs.at(times, interval)
        return self._held(times, self.trajectory.x(times, interval), z, u), u

    def inside(self, tau: Array) -> tuple[Array, Array]:
        """Evaluate every interval at the same places."""
        breaks = self.trajectory.x.breaks
        times = breaks[:-1, None] + np.diff(breaks)[:, None] * tau
        x, (z, u) = self.trajectory.x.inside(tau), self.inputs.inside(tau)
        flat = (values.reshape(times.size, -1) for values in (x, z, u))
        return self._held(times.ravel(), *flat).reshape(z.shape), u

    def _held(self, t: Array, x: Array, z: Array, u: Array) -> Array:
        """Return z with the accelerations and forces of held contacts; one row a time."""
        body, equations = self.phase.body, MotionEquations.of(self.phase)
        assert isinstance(body, InverseRigidBody)
        robot, parameters = body.robot, np.array(list(self.trajectory.parameters.values()), dtype=float)
        nv, forces = robot.nv, len(body.algebraic)
        x, z = np.array(x), np.array(z)
        x[:, : robot.nq] = normalised(robot.model, x[:, : robot.nq])
        rows = equations.rows(t, x, z, u, parameters)[:, :forces, None]
        slopes = equations.slopes(t, x, z, u, parameters)[:, :forces, :forces]
        left, moved = rows[:, :nv], rows[:, nv:]
        mass, jacobian = slopes[:, :nv, :nv], slopes[:, nv:, :nv]
        bases, sizes, _ = np.linalg.svd(jacobian, full_matrices=False)
        kept = sizes > REDUNDANT * sizes.max(axis=1, keepdims=True)
        # Rows that are not kept become zero, and their multipliers too.
        determined = np.swapaxes(bases, 1, 2) * kept[:, :, None]
        across = determined @ jacobian
        free = np.linalg.solve(mass, np.concatenate([np.swapaxes(across, 1, 2), left], axis=2))
        held = across @ free[:, :, :-1] + np.eye(kept.shape[1]) * ~kept[:, None, :]
        multipliers = np.linalg.solve(held, across @ free[:, :, -1:] - determined @ moved)
        z[:, nv:forces] += (np.swapaxes(determined, 1, 2) @ multipliers)[:, :, 0]
        z[:, :nv] += (free[:, :, :-1] @ multipliers - free[:, :, -1:])[:, :, 0]
        return z
