"""Springs at joints: torque -k (q - q_rest), beside motors and damping. A gravity balancer is such a spring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

Spring: TypeAlias = "tuple[str, float, float]"
"""Joint, stiffness [N m/rad, N/m] and position without torque [rad, m]."""


def springs_note(springs: Sequence[Spring], units: Mapping[str, str]) -> str:
    """Name the springs; empty without any."""
    if not springs:
        return ""
    each = (
        f"{joint} {stiffness:.4g} {'N/m' if units[joint] == 'm' else 'N m/rad'} at rest at {rest:.4g} {units[joint]}"
        for joint, stiffness, rest in springs
    )
    return f"Springs pull at {', '.join(each)}."
