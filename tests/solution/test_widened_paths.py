"""A saved solution widens no path: what it claims about folders and trust is not believed."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
LINK = """<robot name="r"><link name="base"/><link name="l"><inertial><mass value="1"/><inertia ixx=".01" iyy=".01"
izz=".01" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry><mesh filename="{}"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="50" velocity="10"/></joint></robot>"""


def claiming(value: Any, folder: str) -> Any:
    """Return the JSON of a solution whose geometries claim trust and folders."""
    if isinstance(value, dict):
        if value.get("$class") == "UrdfGeometry":
            value["fields"] |= {"package_dirs": {"$tuple": [folder]}, "trust_paths": True}
        return {key: claiming(entry, folder) for key, entry in value.items()}
    return [claiming(entry, folder) for entry in value] if isinstance(value, list) else value


@pytest.mark.parametrize("joined", [False, True], ids=["robot", "joined robots"])
def test_meshes_elsewhere_are_not_read(joined: bool, tmp_path: Path) -> None:
    private = tmp_path / "private" / "secret.obj"
    (tmp_path / "mine").mkdir()
    private.parent.mkdir()
    private.write_text(TETRAHEDRON)
    urdf, saved = tmp_path / "mine" / "r.urdf", tmp_path / "mine" / "plan.npz"
    urdf.write_text(LINK.format(private))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = rt.load(urdf)
        if joined:
            robot = rt.robot.join({"a": robot, "b": robot}, at={"b": (1.0, 0.0, 0.0)})
    phase = rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=0.5, v=0), rt.Effort())
    rt.plan(phase, rt.Mesh(4), progress=False).save(saved)
    parts = dict(np.load(saved))
    data = json.dumps(claiming(json.loads(str(parts["solution"])), str(private.parent)))
    assert str(private.parent) in data
    parts["solution"] = np.array(data)
    np.savez_compressed(saved, **parts)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert rt.load_solution(saved).phases[0].phase.robot.visual_model.ngeoms == 0
