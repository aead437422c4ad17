"""A wrong build, frame, reference or model is refused by an error that names it."""

from __future__ import annotations

import pickle
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import pinocchio as pin
import pytest

from robotraj._util.errors import BuildMismatch, InputError, UnknownName
from robotraj._util.system import compiled_modules
from robotraj._util.system.compiled_modules import check_versions, wheel_version
from robotraj.symbolic import SymbolicModel

OTHER = "99.0.0"
MINE = {"PINOCCHIO_VERSION": pin.__version__, "CASADI_VERSION": ca.CasadiMeta.version()}


@pytest.mark.parametrize(("attribute", "name"), [("PINOCCHIO_VERSION", "pinocchio"), ("CASADI_VERSION", "casadi")])
def test_module_built_against_other_versions(attribute: str, name: str) -> None:
    check_versions(SimpleNamespace(**MINE))
    with pytest.raises(BuildMismatch, match=rf"built against {name} {OTHER}, but {name} .* installed"):
        check_versions(SimpleNamespace(**{**MINE, attribute: OTHER}))


def test_library_of_another_version(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """``pin`` and ``libpinocchio`` are separate wheels, and only the second is linked."""
    (tmp_path / f"libpinocchio-{OTHER}.dist-info").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(BuildMismatch, match=f"libpinocchio {OTHER} is installed"):
        check_versions(SimpleNamespace(**MINE))


def test_versions_of_wheels_are_those_that_python_knows() -> None:
    for name in ("libpinocchio", "casadi", "numpy"):
        assert wheel_version(name) == metadata.version(name)
    assert wheel_version("no_such_wheel") is None


def test_missing_module_is_a_build_mismatch_at_import(tmp_path: Path) -> None:
    script = "import sys; sys.modules['robotraj.symbolic._graphs'] = None; import robotraj.symbolic"
    command = [sys.executable, "-c", script]
    result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert result.returncode != 0
    assert "BuildMismatch: " in result.stderr
    assert "pip install" in result.stderr


def test_sources_without_compiled_modules_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inside a clone that was installed without -e, another install of the same kind does not help."""
    (tmp_path / "pyproject.toml").touch()
    monkeypatch.setattr(
        compiled_modules, "__file__", str(tmp_path / "robotraj" / "_util" / "system" / "compiled_modules.py")
    )
    message = str(compiled_modules.not_loaded("robotraj.symbolic.absent", ImportError("no module")))
    assert str(tmp_path) in message
    assert "another folder" in message
    assert "'pip install -e .'" in message
    assert "reinstall" not in message


def test_an_installed_module_that_does_not_load_is_built_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        compiled_modules, "__file__", str(tmp_path / "robotraj" / "_util" / "system" / "compiled_modules.py")
    )
    message = str(compiled_modules.not_loaded("robotraj.symbolic.build", ImportError("undefined symbol")))
    assert "undefined symbol" in message
    assert "--force-reinstall" in message


@pytest.mark.parametrize("method", ["frame_placement", "frame_velocity", "frame_acceleration", "frame_jacobian"])
def test_unknown_frame(arm, method: str) -> None:
    with pytest.raises(UnknownName, match=r"no frame named 'tool_0'. Did you mean 'tool0'"):
        getattr(arm.symbolic, method)("tool_0")
    with pytest.raises(UnknownName, match="no frame named 3"):
        getattr(arm.symbolic, method)(3)


@pytest.mark.parametrize("method", ["frame_velocity", "frame_acceleration", "frame_jacobian"])
def test_unknown_reference(arm, method: str) -> None:
    with pytest.raises(InputError, match="reference is 'local'; give pinocchio.ReferenceFrame"):
        getattr(arm.symbolic, method)("tool0", "local")


def test_something_else_than_a_model(arm) -> None:
    with pytest.raises(InputError, match="model is a Data; give a pinocchio.Model"):
        SymbolicModel(arm.data)


def test_a_model_with_mimic_joints_is_not_pickled_since_pinocchio_cannot_restore_it() -> None:
    model = pin.Model()
    for name in ("left", "right"):
        joint = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), name)
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    coupled = SymbolicModel(pin.transformJointIntoMimic(model, 1, 2, -1.0, 0.0))
    with pytest.raises(InputError, match="cannot restore mimic joints; pickle the rt.robot.Robot"):
        pickle.dumps(coupled)


def test_a_joint_that_follows_one_with_cosine_and_sine_is_refused() -> None:
    model = pin.Model()
    for name in ("left", "right"):
        joint = model.addJoint(0, pin.JointModelRUBX(), pin.SE3.Identity(), name)
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    with pytest.raises(InputError, match="'right' follows a joint whose position is a cosine and a sine"):
        SymbolicModel(pin.transformJointIntoMimic(model, 1, 2, -1.0, 0.0))
