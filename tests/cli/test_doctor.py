"""The doctor names versions, compiler and cache, and states what is missing and how it is mended."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import version

import pytest

from robotraj.cli import doctor
from tests.cli.shell import succeed


def test_the_doctor_prints_versions_and_that_plans_can_be_made() -> None:
    output = " ".join(succeed("doctor").split())
    for name in ("pin", "casadi", "numpy"):
        assert f" {version(name)}" in output
    assert "compiled module _native" in output and "MB in" in output
    assert output.rstrip().endswith("robotraj can plan here")


def test_what_is_missing_has_its_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "EXTRAS", {"no_such_module": ("nothing", "pip install nothing")})
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.delenv("CC", raising=False)
    data = json.loads(succeed("doctor", "--json"))
    assert data["healthy"] and data["missing"]["no_such_module"] == "pip install nothing"
    assert "apt install gcc" in data["missing"]["C compiler"]


def test_the_doctor_works_where_the_compiled_module_does_not() -> None:
    program = (
        "import sys; sys.modules['robotraj.native._native'] = None\nfrom robotraj.cli.app import app; app(['doctor'])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 1 and "Traceback" not in done.stderr
    output = " ".join(done.stdout.split())
    assert "compiled module does not load; " in output and "robotraj cannot plan here" in output
