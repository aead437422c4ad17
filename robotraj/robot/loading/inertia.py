"""Checks of rotational inertias: a rigid body has no negative moment, and none larger than the sum of the others.

Source: Traversaro, Brossette, Escande and Nori, Identification of fully physical consistent inertial parameters (2016).
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robotraj._util.errors import InputError

NEGATIVE = 1e-6
"""Negative moments up to this fraction of the largest one are attributed to rounding."""
TRIANGLE = 1e-2
"""Largest relative excess of a moment over the sum of the two others, for files with few digits."""
ROUNDING = 1e-9
"""Moments below this times the mass [m^2] count as zero: a radius of gyration of 0.03 mm."""


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
    """Refuse moving bodies, links joined by fixed joints together, with an infinite or indefinite inertia.

    Raises
    ------
    InputError
        Names the joints that move them: the mass matrix could lose its positive definiteness.
    """
    bodies = [(model.names[i], np.array(body.inertia), body.mass) for i, body in enumerate(model.inertias) if i]
    # Finite entries of links far apart overflow where their inertias are summed.
    faults = [f"{joint!r} (larger than any number)" for joint, inertia, _ in bodies if not np.isfinite(inertia).all()]
    faults += [
        f"{joint!r} ({triangle_fault(moments, mass)})"
        for joint, inertia, mass in bodies
        if np.isfinite(inertia).all() and is_indefinite(moments := principal_moments(inertia), mass)
    ]
    if faults:
        raise InputError(
            f"{name}: bodies with impossible inertias are moved by joint {'; '.join(faults)}. Correct the URDF."
        )


def weightless_joints(model: pin.Model) -> tuple[str, ...]:
    """Return the joints behind which there is neither mass nor inertia, and which have no armature."""
    carried = [body.mass + float(np.abs(body.inertia).sum()) for body in list(model.inertias)]
    parents = list(model.parents)
    for i in range(model.njoints - 1, 0, -1):
        carried[parents[i]] += carried[i]
    joints = enumerate(model.joints.tolist()[1:], start=1)
    armature = np.array(model.armature)
    return tuple(model.names[i] for i, joint in joints if carried[i] == 0 and not armature[joint.idx_v])
