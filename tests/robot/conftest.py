"""Small URDFs written for one test each."""

from __future__ import annotations

import pytest

LINK = (
    '<link name="{0}"><inertial><origin xyz="0.1 0 -0.3"/><mass value="{1}"/>'
    '<inertia ixx="0.2" iyy="0.3" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial>{2}</link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/>'
    '<origin xyz="0 0.1 -0.5" rpy="0.1 0.2 0.3"/><axis xyz="{4}"/>{5}</joint>'
)
LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/>'


class Urdf:
    """Writes chains base - link1 - link2 ... joined by the given joints."""

    def __init__(self, folder):
        self.folder = folder

    def chain(self, *joints, shapes="", name="chain"):
        """Each joint is (name, type, axis, inside) or (name, type, axis)."""
        parts = [f'<robot name="{name}"><link name="base">{shapes}</link>']
        parent = "base"
        for i, (joint, kind, axis, *inside) in enumerate(joints, start=1):
            child = f"link{i}"
            parts.append(LINK.format(child, i, shapes))
            parts.append(JOINT.format(joint, kind, parent, child, axis, inside[0] if inside else LIMIT))
            parent = child
        return self.text("\n".join([*parts, "</robot>"]), f"{name}.urdf")

    def text(self, text, name="robot.urdf"):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path


@pytest.fixture
def urdf(tmp_path):
    return Urdf(tmp_path)
