"""Robots of four and six legs with straight or folded zeros, as URDF files without an SRDF have them."""

from __future__ import annotations

import numpy as np

import robotraj as rt

FOUR = {"FL": (0.25, 0.12), "FR": (0.25, -0.12), "HL": (-0.25, 0.12), "HR": (-0.25, -0.12)}
SIX = FOUR | {"ML": (0.0, 0.12), "MR": (0.0, -0.12)}


def _link(name, mass, height=0.0):
    return (
        f'<link name="{name}"><inertial><origin xyz="0 0 {height}"/><mass value="{mass}"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def _joint(name, parent, child, axis, place, limit, tilt="0 0 0"):
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{place}" rpy="{tilt}"/><axis xyz="{axis}"/>'
        f'<limit lower="{-limit}" upper="{limit}" velocity="10" effort="15"/></joint>'
    )


def legged(folder, legs, folded=False, right_axis="0 1 0"):
    """Legs of two links of 0.16 m below a hip that abducts; at zero they hang straight, or are folded."""
    parts = [_link("trunk", 6.0)]
    for leg, (x, y) in legs.items():
        axis, side = right_axis if y < 0 else "0 1 0", np.sign(y)
        parts += [
            *(_link(f"{leg}_hip", 0.3), _link(f"{leg}_up", 0.3, -0.08), _link(f"{leg}_low", 0.1, -0.08)),
            _joint(f"{leg}_haa", "trunk", f"{leg}_hip", "1 0 0", f"{x} {y} 0", 1.0),
            _joint(f"{leg}_hfe", f"{leg}_hip", f"{leg}_up", axis, f"0 {0.05 * side} 0", 3.0),
            _joint(f"{leg}_kfe", f"{leg}_up", f"{leg}_low", axis, "0 0 -0.16", 3.0, "0 3.1 0" if folded else "0 0 0"),
            f'<link name="{leg}_foot"/><joint name="{leg}_ankle" type="fixed"><parent link="{leg}_low"/>'
            f'<child link="{leg}_foot"/><origin xyz="0 0 -0.16"/></joint>',
        ]
    path = folder / "legged.urdf"
    path.write_text(f'<robot name="legged">{"".join(parts)}</robot>')
    return rt.load(path, root="floating")
