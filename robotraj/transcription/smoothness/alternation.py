"""Accelerations that do not alternate with the mesh, beside a duration that is minimised.

The curves of an interval are polynomials through its nodes. What alternates from node to node is in the coefficient of
their highest degree, which for smooth curves falls with that power of the interval's length. At nodes n_i it is

    e = sum_i c_i a_i,    c_i proportional to 1 / prod_{k != i} (n_i - n_k),    max |c_i| = 1,

for Hermite-Simpson a(1/2) - (a(0) + a(1)) / 2. With the inertias M of the robot in its neutral configuration and the
largest torques tau_j, the program of the solver adds

    smoothing ALTERNATING times the integral of r dt,    r = mean of ((M e)_j / tau_j)^2,

to a duration. On singular arcs, such as those beside obstacles, torques that alternate gain time on any mesh. Teeth of
a share d of the limit count as d^2, and smooth torques as nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.problem.augmentation import free_of
from robotraj.problem.phase import Phase
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.assembly.point_functions import PointFunctions
from robotraj.transcription.assembly.triplets import Triplets
from robotraj.transcription.exact_motion import is_exact
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.layout import PhaseLayout
from robotraj.transcription.schemes.collocation import Collocation, Scheme
from robotraj.transcription.smoothness.smoothing import weight_of_duration

ALTERNATING = 1.0
"""Weight of squares of alternating torques relative to that of squares of torques.

Less leaves teeth. More delays the switches of torques on coarse meshes, and with limits that are lowered between the
points it delays them further on every round: see ``benchmarks/smoothness_weights.md``."""
LEAST_NODES = 3
"""Nodes from which values can alternate inside an interval."""


def alternation_block(phase: Phase, layout: PhaseLayout, smoothing: float) -> Block | None:
    """Return the block of this cost, with one place an interval; None where nothing alternates or is smoothed."""
    weight = alternation_weight(phase, [run.scheme for run in layout.runs], smoothing)
    if not weight:
        return None
    known = _FUNCTIONS.setdefault(phase, {})
    free, count = layout.duration.column, layout.count
    if (free is not None) not in known:
        known[free is not None] = _functions(phase, free is not None)
    stage, joints = known[free is not None], len(phase.dae.algebraic)
    gather, weights = Triplets(), np.zeros(count)
    for run in layout.runs:
        assert isinstance(run.scheme, Collocation)
        weights[run.which] = weight * run.length
        for node, factor in enumerate(highest_coefficient(run.scheme.nodes)):
            gather.spread(run.which[:, None] * stage.inputs + np.arange(joints), run.algebraic[:, node], factor)
    if free is not None:
        gather.add(np.arange(count) * stage.inputs + joints, np.full(count, free), 1.0)
    constants = np.full((int(stage.c.numel()), count), layout.duration.value)
    columns = 1 + max(-1 if free is None else free, *(int(run.algebraic.max()) for run in layout.runs))
    reads, nothing = gather.matrix((stage.inputs * count, columns)), Triplets().matrix((0, count))
    return Block(stage, reads, constants, nothing, weights)


def alternation_cost(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme], smoothing: float) -> float:
    """Return what this adds to the objective of a motion."""
    weight = alternation_weight(phase, schemes, smoothing)
    if not weight:
        return 0.0
    shares, lengths, total = _shares(phase), np.diff(trajectory.x.breaks), 0.0
    for scheme in dict.fromkeys(schemes):
        assert isinstance(scheme, Collocation)
        which = [k for k, each in enumerate(schemes) if each == scheme]
        values = trajectory.z.inside(scheme.nodes)[which]
        torques = np.einsum("i,kij->kj", highest_coefficient(scheme.nodes), values) @ shares.T
        total += float(lengths[which] @ (torques**2).mean(axis=1))
    return weight * total


def alternation_weight(phase: Phase, schemes: Sequence[Scheme], smoothing: float) -> float:
    """Return the weight of r; 0 where no duration is minimised, on a path, and without exact motions."""
    weight = weight_of_duration(phase) * smoothing * ALTERNATING
    if weight <= 0.0 or phase.path is not None or not is_exact(phase, schemes):
        return 0.0
    few = any(len(scheme.nodes) < LEAST_NODES for scheme in schemes if isinstance(scheme, Collocation))
    return 0.0 if few or not len(_shares(phase)) else weight


def highest_coefficient(nodes: Array) -> Array:
    """Return the factors c (s,) of values at nodes (s,) that give the coefficient of their highest degree."""
    factors = 1.0 / (nodes[:, None] - nodes + np.eye(len(nodes))).prod(axis=1)
    return np.asarray(factors / np.abs(factors).max())


_FUNCTIONS: WeakKeyDictionary[Phase, dict[bool, PointFunctions]] = WeakKeyDictionary()
"""Functions of phases that are transcribed again, by whether the duration is free."""


def _functions(phase: Phase, free: bool) -> PointFunctions:
    """Return T times the mean square of the alternating torques."""
    shares = _shares(phase)
    e, duration = ca.SX.sym("e", shares.shape[1]), ca.SX.sym("T")
    torques = ca.DM(shares) @ e
    cost = duration * ca.dot(torques, torques) / len(shares)
    unknowns, constants = (ca.vertcat(e, duration), ca.SX(0, 1)) if free else (e, duration)
    return PointFunctions(unknowns, constants, cost, costed=0)


def _shares(phase: Phase) -> Array:
    """Return the torques of unit algebraic variables relative to the limits (m, nz), of motors that are limited."""
    body, algebraic = free_of(phase.body), [variable.name for variable in phase.dae.algebraic]
    assert isinstance(body, InverseRigidBody)
    robot, model = body.robot, body.robot.model
    sides = phase.rows.limits_of(tuple(each for each in phase.dae.controls if each.name.startswith("tau.")))
    size = np.maximum(*map(np.abs, sides))
    limited = np.flatnonzero(np.isfinite(size) & (size > 0.0))
    upper = np.triu(pin.crba(model, model.createData(), robot.neutral))
    inertia = (upper + np.triu(upper, 1).T)[limited] / size[limited, None]
    shares = np.zeros((len(limited), len(algebraic)))
    shares[:, [algebraic.index(f"a.{joint}") for joint in robot.velocity_names]] = inertia
    return shares
