"""Checks of rotational inertias: a rigid body has no negative moment, and none larger than the sum of the others.

Source: Traversaro, Brossette, Escande and Nori, Identification of fully physical consistent inertial parameters (2016).
"""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj.robot.coupling.dynamics import mass_matrix
from robotraj.robot.loading.planning_model import names_of, parents_of, reduced

NEGATIVE = 1e-6
"""Negative moments up to this fraction of the largest one are attributed to rounding."""
TRIANGLE = 1e-2
"""Largest relative excess of a moment over the sum of the two others, for files with few digits."""
ROUNDING = 1e-9
"""Moments below this times the mass [m^2] count as zero: a radius of gyration of 0.03 mm."""
SINGULAR = 1e-10
"""Eigenvalues of the mass matrix, scaled to a diagonal of ones, that count as zero; those of robots are above 1e-4."""
TAKING_PART = 1e-2
"""Entries of an eigenvector, relative to the largest one, from which a joint takes part in the motion."""


def principal_moments(inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the eigenvalues (..., 3) of inertias (..., 3, 3) about the centre of mass, in ascending order [kg m^2]."""
    return np.asarray(np.linalg.eigvalsh(inertia))


def is_indefinite(moments: NDArray[np.float64], mass: float) -> bool:
    """Whether a principal moment is negative by more than rounding."""
    return bool(moments[0] < -NEGATIVE * np.abs(moments).max() - ROUNDING * mass)


def triangle_fault(moments: NDArray[np.float64], mass: float) -> str:
    """Describe principal moments of no rigid body; empty where they are possible.

    Parameters
    ----------
    moments : (3,) array
        Principal moments in ascending order [kg m^2].
    mass : float
        Mass [kg], which scales the tolerance.
    """
    if is_indefinite(moments, mass):
        return f"the principal moments of inertia {_listed(moments)} kg m^2, one of them negative"
    if moments[0] + moments[1] < (1.0 - TRIANGLE) * moments[2] - ROUNDING * mass:
        return f"the principal moments of inertia {_listed(moments)} kg m^2, the last larger than the sum of the others"
    return ""


def _listed(moments: NDArray[np.float64]) -> str:
    return ", ".join(f"{moment:.4g}" for moment in moments)


def check_bodies(name: str, model: pin.Model) -> None:
    """Refuse moving bodies with a negative mass, or an infinite or indefinite inertia.

    Links joined by fixed joints are one body.

    Raises
    ------
    InputError
        Names the joints that move them: the mass matrix could lose its positive definiteness.
    """
    bodies, joints = model.inertias.tolist()[1:], names_of(model)[1:]
    inertias = np.array([body.inertia for body in bodies]).reshape(-1, 3, 3)
    # Finite entries of links far apart overflow where their inertias are summed.
    finite = np.isfinite(inertias).all(axis=(1, 2))
    faults = [f"{joint!r} (larger than any number)" for joint, fine in zip(joints, finite, strict=True) if not fine]
    faults += [
        f"{joint!r} (a mass of {body.mass:g} kg)"
        for joint, body in zip(joints, bodies, strict=True)
        if not (0.0 <= body.mass < np.inf and np.isfinite(body.lever).all())
    ]
    every = principal_moments(np.where(finite[:, None, None], inertias, 0.0))
    faults += [
        f"{joint!r} ({triangle_fault(moments, body.mass)})"
        for joint, body, moments in zip(joints, bodies, every, strict=True)
        if is_indefinite(moments, body.mass)
    ]
    if faults:
        raise InputError(
            f"{name}: bodies with impossible inertias are moved by joint {'; '.join(faults)}. Correct the file."
        )


def weightless_joints(model: pin.Model) -> tuple[str, ...]:
    """Return the joints behind which there is neither mass nor inertia, and which have no armature."""
    moved = _moved(model, lambda body: body.mass + np.abs(body.inertia).sum()) + np.array(model.armature)
    joints = model.joints.tolist()
    return tuple(model.names[i] for i, joint in enumerate(joints) if i and joint.nv and not moved[joint.idx_v])


def _moved(model: pin.Model, amount: Callable[[pin.Inertia], float]) -> NDArray[np.float64]:
    """Sum an amount of the bodies behind each joint, at its first velocity (nv,)."""
    carried = [float(amount(body)) for body in model.inertias.tolist()]
    parents, moved = parents_of(model), np.zeros(model.nv)
    for i in range(model.njoints - 1, 0, -1):
        carried[parents[i]] += carried[i]
    # A leader moves what its followers carry.
    for joint, what in list(zip(model.joints.tolist(), carried, strict=True))[1:]:
        moved[joint.idx_v] += what
    return moved


def weightless_together(model: pin.Model, q: NDArray[np.float64], root: int) -> tuple[int, ...]:
    """Return the indices in v of joints that move without kinetic energy at q, each alone or all together.

    A link with mass and no inertia about its centre of mass does not resist a turn about an axis through that centre.
    The first ``root`` velocities are those of a root, at rest: contacts may hold a root without mass.
    """
    mass = mass_matrix(model, model.createData(), q)[root:, root:]
    moments = np.diag(mass)
    still = np.flatnonzero(moments <= ROUNDING * _moved(model, lambda body: body.mass)[root:])
    if still.size:
        return tuple(root + int(i) for i in still)
    sizes = np.sqrt(moments)
    values, vectors = np.linalg.eigh(mass / np.outer(sizes, sizes))
    if not len(values) or values[0] > SINGULAR:
        return ()
    speeds = np.abs(vectors[:, 0] / sizes)
    return tuple(root + int(i) for i in np.flatnonzero(speeds > TAKING_PART * speeds.max()))


def idle_joints(
    model: pin.Model, q: NDArray[np.float64], root: int, held: Collection[str], kept: Collection[str]
) -> tuple[str, ...]:
    """Return joints without which no others move without kinetic energy at q, alone or together; none of the root.

    The last joint is taken of those that move together. There are none in a model without any mass, which has no
    dynamics.

    Parameters
    ----------
    model : pinocchio.Model
        Its joints after the root are independent and have one position each.
    q : ndarray (nq,)
    root : int
        Number of velocities of the root.
    held, kept : collection of str
        Joints that are locked, and joints that must not be.
    """
    found: list[str] = []
    while any(body.mass for body in model.inertias.tolist()[1:]):
        ids = [model.getJointId(joint) for joint in (*held, *found)]
        rest = reduced(model, ids, q)
        free = [*[""] * root, *names_of(rest)[len(rest.names) - (rest.nv - root) :]]
        together = weightless_together(rest, np.delete(q, [model.joints[i].idx_q for i in ids]), root)
        idle = [joint for joint in weightless_joints(rest) if joint in free]
        idle = [joint for joint in idle or [free[i] for i in together] if joint not in kept]
        if not idle:
            break
        found.append(idle[-1])
    return tuple(found)
