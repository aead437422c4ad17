"""Nothing of the working folder runs, whatever process the package starts there."""

from __future__ import annotations

import os
import re
import stat
import subprocess
import sys
import time
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

import robotraj

PROGRAMS = ("gcc", "clang", "cc", "as", "ld", "cc1", "collect2", "latex", "uname", "python", "sh")
STARTERS = {
    "_util/system/limited.py",
    "_util/system/own_python.py",
    "native/engines/compiled.py",
    "native/engines/compiler.py",
    "applications/many/processes.py",
}
"""Files that start processes; each is started by a test below."""
PROBLEM = """
[robot]
source = "two_link_arm"
[[phases]]
duration = 5.0
start = {{ q = 0, v = 0 }}
end = {{ q = [0.5, 0.5], v = 0 }}
objective = "Effort"
[plan]
mesh = {{ intervals = 20, scheme = "HermiteSimpson" }}
engine = {{ type = "Compiled", least = 1, wait = {wait} }}
solver = "Ipopt"
[output]
plot = "curves.png"
"""
SWEEP = """
import robotraj as rt
system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
phase = rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), rt.Lagrange(lambda point: point.u["u"] ** 2))
assert [each.success for each in rt.sweep([phase, phase], mesh=rt.Mesh(4))] == [True, True]
late = rt.Phase(system, 1.0, rt.State([0]), rt.State([1]), controls={"u": rt.between(-0.5, 0.5)})
assert not rt.plan(late, check=False).success
from robotraj.replay_page.scene.visuals import read_meshes
shapes = rt.load("ur5").visual_model.geometryObjects
parts = read_meshes([shape.meshPath for shape in shapes])
assert len(parts) == 7 and not any(isinstance(each, str) for each in parts.values())
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A working folder with a module, a program or a file of settings for every name that may be looked up."""
    planted, ran = tmp_path / "planted", tmp_path / "ran"
    planted.mkdir()
    for name in {*sys.stdlib_module_names, *packages_distributions()}:
        if re.fullmatch(r"\w+", name):
            (planted / f"{name}.py").write_text(f"open({str(ran)!r}, 'a').write(__name__ + '\\n')\n")
    for name in PROGRAMS:
        program = planted / name
        program.write_text(f"#!/bin/sh\necho {name} >> {ran}\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
    (planted / "stdint.h").write_text("#error the header of the working folder\n")
    (planted / "ipopt.opt").write_text(f"output_file {ran}\n")
    (planted / "matplotlibrc").write_text("text.usetex: True\nbackend: module://shutil\n")
    return planted


@pytest.fixture
def surroundings(tmp_path: Path) -> dict[str, str]:
    """An environment whose search paths begin with the working folder."""
    others = {name: f":{os.environ.get(name, '')}" for name in ("PATH", "CPATH", "LIBRARY_PATH", "LD_LIBRARY_PATH")}
    without = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    return {**without, **others, "XDG_CACHE_HOME": str(tmp_path / "cache"), "OMP_NUM_THREADS": "1"}


@pytest.fixture
def shell(tmp_path: Path) -> Path:
    """The script that an installation writes for the command ``robotraj``."""
    script = tmp_path / "bin" / "robotraj"
    script.parent.mkdir()
    script.write_text("from robotraj.cli.app import app\napp()\n")
    return script


def untouched(folder: Path) -> bool:
    return not (folder.parent / "ran").exists()


def test_the_planted_files_would_be_noticed(folder: Path, surroundings: dict[str, str]) -> None:
    subprocess.run([sys.executable, "-m", "robotraj.native.engines"], cwd=folder, capture_output=True, check=False)
    assert not untouched(folder)
    (folder.parent / "ran").unlink()
    subprocess.run("gcc", cwd=folder, env=surroundings, shell=True, check=True)
    assert not untouched(folder)


@pytest.mark.slow
@pytest.mark.parametrize("wait", ["true", "false"])
def test_a_plan_at_the_shell(folder: Path, surroundings: dict[str, str], shell: Path, wait: str) -> None:
    (folder / "problem.toml").write_text(PROBLEM.format(wait=wait))
    done = subprocess.run(
        [sys.executable, str(shell), "plan", "problem.toml"],
        cwd=folder,
        env=surroundings,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert (folder / "curves.png").stat().st_size > 1000
    engines = folder.parent / "cache" / "robotraj" / "engines"
    for _ in range(600):
        if list(engines.glob("*.so")) and not list(engines.glob("build-*")):
            break
        time.sleep(0.1)
    log = engines / "background.log"
    assert list(engines.glob("*.so")), log.read_text() if log.exists() else "not started"
    assert untouched(folder)
    kinds = {path.suffix for path in engines.iterdir()}
    assert kinds <= {".so", ".digest", ".lock", ".log"}


@pytest.mark.slow
def test_workers_and_solvers_of_a_script(folder: Path, surroundings: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "scripts").mkdir()
    script = tmp_path / "scripts" / "sweep.py"
    script.write_text(SWEEP)
    subprocess.run([sys.executable, str(script)], cwd=folder, env=surroundings, check=True)
    assert untouched(folder)


def test_no_other_file_starts_a_process() -> None:
    package = Path(robotraj.__file__).parent
    starts = re.compile(
        r"\bimport subprocess|\bmultiprocessing|\bProcessPoolExecutor\(|sys\.executable"
        r"|\bos\.(system|popen|exec[lv]\w*|spawn\w+|fork|posix_spawn)\("
    )
    code = {path: re.sub(r'"""(.|\n)*?"""|#.*', "", path.read_text()) for path in package.rglob("*.py")}
    found = {path.relative_to(package).as_posix() for path, text in code.items() if starts.search(text)}
    assert found == STARTERS
