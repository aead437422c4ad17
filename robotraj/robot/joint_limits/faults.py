"""Limits that lock or contradict a joint, in words with the remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

UNDRIVEN = "effort limit 0 locks it"
"""Fault of a joint that files of passive joints state as well."""
SHOWN = 8
"""Largest number of joints that a sentence names."""


def fault_of(quantity: str, low: float, high: float, missing: bool) -> str:
    """Describe what is wrong with the limits of one joint; empty if they allow motion.

    ``missing`` is whether the URDF states no position limits, which Pinocchio reads as [0, 0].
    """
    if np.isnan(low) or np.isnan(high):
        return f"{quantity} limits [{low:g}, {high:g}] are not numbers"
    if low > high:
        return f"{quantity} limits [{low:g}, {high:g}] are inverted"
    if low < high:
        return ""
    if quantity == "position":
        return "position limits are missing" if missing else f"position limits [{low:g}, {high:g}] lock it"
    return UNDRIVEN.replace("effort", quantity) if high == 0.0 else f"{quantity} limits [{low:g}, {high:g}] fix it"


def sentences(faults: Mapping[str, Mapping[str, str]], rest: Mapping[str, float]) -> tuple[str, ...]:
    """Return one sentence for the joints that have the same faults, with the calls that mend it.

    Parameters
    ----------
    faults : mapping by joint
        Descriptions by quantity.
    rest : mapping by joint
        Lower position limits [rad, m]: where a joint that they lock could be held.
    """
    alike: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for joint, of_joint in faults.items():
        alike.setdefault(tuple(of_joint.items()), []).append(joint)
    return tuple(_sentence(joints, dict(same), rest) for same, joints in alike.items())


def _sentence(joints: Sequence[str], faults: Mapping[str, str], rest: Mapping[str, float]) -> str:
    first, many = joints[0], len(joints) > 1
    more = ", ..." if many else ""
    cures = ", ".join(f"{name!r}: {{{first!r}: {_example(name)}{more}}}" for name in faults)
    shown = ", ".join(map(repr, joints[:SHOWN]))
    if len(joints) > SHOWN:
        shown += f" and {len(joints) - SHOWN} more"
    driven = f"leave {'them' if many else 'it'} out of actuated=[...] if no motor drives {'them' if many else 'it'}, "
    passive = driven if faults.get("effort") == UNDRIVEN else ""
    held = rest[first] if "position" in faults and np.isfinite(rest[first]) else 0.0
    return (
        f"{'Joints' if many else 'Joint'} {shown} cannot be planned with {'their' if many else 'its'} limits: "
        f"{', '.join(faults.values())}. Give others with rt.load(..., limits={{{cures}}}) or "
        f"Phase(limits=robot.limits.with_(...)), {passive}hold {'them' if many else 'it'} still with "
        f"rt.load(..., locked={{{first!r}: {held:g}{more}}}), or remove all limits with Phase(limits=None)."
    )


def _example(quantity: str) -> str:
    return "(lower, upper)" if quantity == "position" else "largest"
