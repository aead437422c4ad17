"""The planned motion of one phase: its polynomials, evaluated anywhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, overload

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.errors import InputError
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.expression_values import rows_of
from robotraj.dynamics.path_body import PathBody
from robotraj.dynamics.variable import Named, Variable
from robotraj.problem.augmentation import Augmented
from robotraj.problem.phase import Phase
from robotraj.problem.sizes.motion_sizes import same_variables
from robotraj.robot.robot import Robot
from robotraj.robot.tangent import normalised
from robotraj.solution.sample import JointSample, Sample, Times, as_times, no_forces
from robotraj.transcription.driven_motion import Inputs, inputs_of
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.point_values import PointValues, joints_on_path
from robotraj.transcription.schemes.mesh import Mesh

JOINT_SITES = 7
"""Number of places of an interval through which positions and velocities on a path are interpolated."""


@dataclass(frozen=True, eq=False)
class PhaseSolution(OneLine):
    """The planned motion of one phase, in global time.

    Attributes
    ----------
    phase : Phase
    mesh : Mesh
    trajectory : PhaseTrajectory
        The polynomials x, z and u.
    """

    phase: Phase
    mesh: Mesh
    trajectory: PhaseTrajectory

    @property
    def t0(self) -> float:
        """Start [s]."""
        return self.trajectory.t0

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return self.trajectory.duration

    @property
    def knots(self) -> Array:
        """Times of the knots [s], (K + 1,)."""
        return self.trajectory.x.breaks

    @property
    def points(self) -> Array:
        """Times of the collocation points [s]."""
        return self.trajectory.points

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the phase's parameters."""
        return self.trajectory.parameters

    @cached_property
    def robot(self) -> Robot | None:
        """The robot with the values of the phase's design parameters; None for a System."""
        from robotraj.dynamics.design.binding import realised

        return None if self.phase.robot is None else realised(self)

    @cached_property
    def exact(self) -> bool:
        """Whether the plan satisfies its equations of motion at any time (``transcription.exact_motion``)."""
        return is_exact(self.phase, self.mesh.given)

    @property
    def _fitting(self) -> PhaseTrajectory:
        """The trajectory, whose variables are those of the phase.

        Raises
        ------
        InputError
            It is that of another phase.
        """
        dae, path = self.phase.dae, self.trajectory
        kinds = ((path.x, dae.states, "states"), (path.z, dae.algebraic, "algebraic variables"))
        for found, variables, what in (*kinds, (path.u, dae.controls, "controls")):
            count = found.values[0].shape[-1]
            if count != len(variables):
                raise InputError(
                    f"The trajectory has {count} {what}, but phase {self.phase.name!r} has {len(variables)}. A motion "
                    "belongs to the phase that it was planned for, with its contacts and objective."
                )
        return path

    @cached_property
    def inputs(self) -> Inputs:
        """Algebraic variables and controls along the motion: by the equations of motion where these give them."""
        return inputs_of(self.phase, self._fitting, self.mesh.schemes)

    @cached_property
    def joint_states(self) -> PiecewisePolynomial:
        """Positions and velocities of a robot, (nq + nv,) first; on a path, polynomials through the true values."""
        x = self.trajectory.x
        if self.phase.path is None:
            return x
        sites = lobatto_sites(JOINT_SITES)
        times = x.breaks[:-1, None] + np.diff(x.breaks)[:, None] * sites
        sample = self.at(times.ravel(), np.repeat(np.arange(len(times)), len(sites)))
        values = np.hstack([sample.q, sample.v]).reshape(*times.shape, -1)
        return PiecewisePolynomial(x.breaks, [sites] * len(times), list(values))

    @cached_property
    def _rates(self) -> PiecewisePolynomial:
        return self.trajectory.x.derivative()

    @overload
    def at(self, t: float, interval: int | NDArray[np.int_] | None = None) -> Sample[float]: ...
    @overload
    def at(self, t: Sequence[float] | Array, interval: int | NDArray[np.int_] | None = None) -> Sample[Array]: ...
    @overload
    def at(self, t: Times, interval: int | NDArray[np.int_] | None = None) -> Sample[Any]: ...

    def at(self, t: Times, interval: int | NDArray[np.int_] | None = None) -> Sample[Any]:
        """Evaluate the states' polynomials, and by the equations of motion (``driven_motion``) torques and forces.

        Parameters
        ----------
        t : float or array (m,)
            Global time [s] within the phase.
        interval : int or array (m,), optional
            Interval whose polynomial is evaluated, or one for each time, for one-sided values at knots.

        Raises
        ------
        InputError
            A time outside the phase, or what is no time.
        """
        times = self._within(as_times(t), interval)
        dae = self.phase.dae
        x, z, u = self._numbers(times, interval)
        controls, algebraics = dae.controls, dae.algebraic
        body = self.phase.body
        if isinstance(dae, Augmented):
            # Controls or forces that the objective made states are those of the states.
            columns = zip((*dae.states, *algebraics, *controls), (*x.T, *z.T, *u.T), strict=True)
            known = {v.name: column for v, column in columns}
            controls = (*body.controls, *(c for c in controls if c not in body.controls))
            algebraics = (*body.algebraic, *(v for v in algebraics if v not in body.algebraic))
            u, z = (
                np.stack([known[v.name] for v in kind], axis=-1) if kind else np.empty((*times.shape, 0))
                for kind in (controls, algebraics)
            )
        states: Named[float | Array] = Named("state", [v.name for v in dae.states], x.T)
        algebraic: Named[float | Array] = Named("algebraic variable", [v.name for v in algebraics], z.T)
        named_controls: Named[float | Array] = Named("control", [v.name for v in controls], u.T)
        known_times = times if times.ndim else float(times)
        robot = self.phase.robot
        sample: Sample[Any] = Sample(known_times, states, algebraic, named_controls, no_forces())
        if self.phase.path is not None:
            return self._on_path(self.phase.path, sample, x, self.inputs.at(times, interval))
        if robot is None:
            return sample
        end = robot.nq + robot.nv
        accelerations = self._rates(times, interval)[..., robot.nq : end]
        # Polynomials of a quaternion have length 1 at collocation points, and nearly 1 in between.
        q = normalised(robot.model, x[..., : robot.nq])
        v, tau = x[..., robot.nq : end], u[..., : robot.nu]
        forces = self._forces(algebraic)
        return JointSample(known_times, states, algebraic, named_controls, forces, q, v, accelerations, tau)

    def _within(self, times: Array, interval: int | NDArray[np.int_] | None) -> Array:
        """Return the times; refuse those outside the phase, and intervals that it does not have."""
        slack = 1e-9 * max(1.0, self.duration)
        outside = (times < self.t0 - slack) | (times > self.t0 + self.duration + slack) | np.isnan(times)
        if np.any(outside):
            bad = float(np.atleast_1d(times)[np.atleast_1d(outside)][0])
            raise InputError(
                f"t = {bad:g} s lies outside phase {self.phase.name!r}, which runs from {self.t0:g} s to "
                f"{self.t0 + self.duration:g} s."
            )
        count = len(self.knots) - 1
        if interval is not None and not np.all((np.asarray(interval) >= 0) & (np.asarray(interval) < count)):
            raise InputError(f"Phase {self.phase.name!r} has no interval {interval}; they run from 0 to {count - 1}.")
        return times

    def values(
        self, expression: Callable[[Any], object], t: Times, interval: int | NDArray[np.int_] | None = None
    ) -> Array:
        """Evaluate an expression of a point, as objectives and constraints take it, along the motion.

        Parameters
        ----------
        expression : callable
            From a ``Point`` to a number or a column of n: ``lambda point: point.frame("tool0").velocity``, (6,).
        t, interval
            As for ``at``.

        Returns
        -------
        ndarray (n,) or (m, n)

        Raises
        ------
        InputError
            A time outside the phase. A FailedExpression names an error of the function.
        """
        times = self._within(as_times(t), interval)
        table = self.phase.rows
        function = PointValues(table, lambda point: ca.vertcat(*rows_of("expression", expression, point)))
        x, z, u = (np.reshape(each, (times.size, -1)) for each in self._numbers(times, interval))
        found = function.at(times.ravel(), x, z, u, np.array(list(self.parameters.values()), dtype=float))
        return found.reshape(*times.shape, -1)

    def _numbers(self, times: Array, interval: int | NDArray[np.int_] | None) -> tuple[Array, Array, Array]:
        return self.trajectory.x(times, interval), *self.inputs.at(times, interval)

    def _on_path(self, body: PathBody, sample: Sample[Any], x: Array, inputs: tuple[Array, Array]) -> Sample[Any]:
        """Add the motion of the joints on a path; their variables come before those of the path."""
        shape, times = np.shape(sample.t), np.atleast_1d(sample.t)
        x, z, u = (np.reshape(each, (len(times), -1)) for each in (x, *inputs))
        p = np.array(list(self.parameters.values()), dtype=float)
        found = joints_on_path(self.phase.rows).at(times, x, z, u, p)
        q, v, a, tau = (each.reshape(*shape, -1) for each in np.split(found, 4, axis=1))
        states = _joined(body.free.states, np.concatenate([q, v], axis=-1), sample.x)
        algebraic = _joined(body.free.algebraic, a, sample.z)
        controls = _joined(body.free.controls, tau, sample.u)
        return JointSample(sample.t, states, algebraic, controls, sample.forces, q, v, a, tau)

    def _forces(self, algebraic: Named[float | Array]) -> Named[Array]:
        """Return contact forces in world axes, (3,) or (6,) each, or (m, 3) or (m, 6) for m times."""
        contacts = self.phase.bound_contacts
        vectors = []
        for contact in contacts:
            entries = contact.vector([algebraic[force.name] for force in contact.forces])
            vectors.append(np.stack(np.broadcast_arrays(*entries), axis=-1))
        return Named("contact", [contact.name for contact in contacts], vectors)

    def columns(self, times: Array, names: Sequence[str]) -> list[Array]:
        """Values of named variables at times, (m,) each; accelerations come from the states, unknown names are 0."""
        times = np.clip(times, self.t0, self.t0 + self.duration)
        states = {v.name: i for i, v in enumerate(self.phase.dae.states)}
        if self.phase.path is None and states.keys() >= set(names):
            # States alone need no equations of motion.
            x = self.trajectory.x(times)
            return [x[:, states[name]] for name in names]
        sample = self.at(times)
        values = {**sample.x, **sample.z, **sample.u}
        if self.phase.robot is not None:
            joints = self.phase.robot.velocity_names
            values |= {f"a.{joint}": sample.a[:, i] for i, joint in enumerate(joints) if f"a.{joint}" not in values}
        return [np.asarray(values.get(name, np.zeros(len(times)))) for name in names]


def _joined(variables: Sequence[Variable], values: Array, known: Named[float | Array]) -> Named[float | Array]:
    """Return variables with their values, (n,) or (m, n), before known ones."""
    every = {v.name: values[..., i] for i, v in enumerate(variables)} | dict(known)
    return Named(known.kind, list(every), list(every.values()))


def alike(part: PhaseSolution, parts: Sequence[PhaseSolution]) -> list[PhaseTrajectory]:
    """Return the trajectories of the other phases with the same variables."""
    same = same_variables([each.phase for each in parts], part.phase)
    return [parts[i].trajectory for i in same if parts[i] is not part]
