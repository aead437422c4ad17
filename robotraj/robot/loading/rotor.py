"""Rotor inertia as armature: Pinocchio's algorithms use the armature, and ignore the rotor inertia.

armature = rotor inertia * (gear ratio)^2, per joint [kg m^2, kg] (Featherstone 2008, section 9.6).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

from robotraj._util.system.regular_files import contents
from robotraj.robot.urdf.xml import MAX_BYTES


def with_rotors(model: pin.Model, srdf: Path | None) -> tuple[pin.Model, str]:
    """Copy a model with rotor inertias added as armature where it has none, and state their source.

    Parameters
    ----------
    model : pinocchio.Model
        Read only.
    srdf : Path, optional
        A file whose ``<rotor_params>`` hold the rotors, where the robot has one.

    Returns
    -------
    model, note
        The copy, and a sentence on the source of the armature (empty when there is none).
    """
    copy = model.copy()
    source = "the model's own armature"
    if srdf is not None and "<rotor_params" in contents(srdf, MAX_BYTES, "The SRDF file").decode("utf-8", "replace"):
        pin.loadRotorParameters(copy, str(srdf))
        source = f"the rotors in {srdf.name}"
    reflected = np.array(copy.rotorInertia) * np.array(copy.rotorGearRatio) ** 2
    missing = np.array(copy.armature) == 0
    if np.any(reflected[missing] != 0) and source == "the model's own armature":
        source = "the model's rotor inertias and gear ratios"
    copy.armature[:] = np.where(missing, reflected, copy.armature)
    if not np.any(copy.armature):
        return copy, ""
    return copy, f"Armature (inertia of the rotors, seen at the joints) comes from {source}."
