"""Executes the code of other tools on the pages docs/how-to/coming-from, each in an environment of its own.

    python docs/other_tools/run.py [--cache FOLDER] [TOOL ...]

pip installs Drake, Crocoddyl and Dymos. MATLAB code runs in GNU Octave, where functions of this folder stand in for
OptimTraj and for GPOPS-II, which need MATLAB or a licence. A tool that cannot be installed is named and left out.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGES = HERE.parent / "how-to" / "coming-from"
sys.path.insert(0, str(HERE.parents[1] / "benchmarks" / "peers"))

import run as peers  # noqa: E402
import urdf  # noqa: E402
from environments import DEFAULT_CACHE, python_of  # noqa: E402
from tasks import task_of  # noqa: E402

MINUTES = 5


class Missing(Exception):
    """A tool is not on this machine and cannot be put there."""


def blocks(page: str, language: str) -> str:
    """Code of a page in one language."""
    text = (PAGES / page).read_text()
    found = re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    if not found:
        raise ValueError(f"{page} has no block of {language}")
    return "".join(found)


def installed(environment: str, cache: Path) -> Path:
    """Return the interpreter of a peer's environment."""
    try:
        return python_of(environment, cache)
    except RuntimeError as error:
        raise Missing(str(error)) from error


def printed_by(command: list[str]) -> float:
    """Run a program in an empty folder; return the number on its last line."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60 * MINUTES)
    if done.returncode:
        raise RuntimeError(f"{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return float(done.stdout.split()[-1])


@dataclass(frozen=True)
class Script:
    """A function that a page shows and that the comparison with peers runs."""

    tool: str
    task: str

    def objective(self, cache: Path) -> float:
        """Run it on a task; return what it finds."""
        tool = peers.TOOLS[self.tool]
        assert tool.environment
        python = installed(tool.environment, cache)
        urdf.write(task_of(self.task).urdf, cache / "urdf")
        figures = peers.run_once(self.task, self.tool, python, cache)
        if "failed" in figures:
            raise RuntimeError(figures["failed"])
        return float(figures["objective"])


@dataclass(frozen=True)
class Python:
    """Blocks of a page that run in a peer's environment."""

    page: str
    environment: str
    shown: str

    def objective(self, cache: Path) -> float:
        """Run them; return the value of ``shown``."""
        code = blocks(self.page, "py") + f"\nprint()\nprint(float({self.shown}))\n"
        return printed_by([str(installed(self.environment, cache)), "-W", "ignore", "-c", code])


@dataclass(frozen=True)
class Matlab:
    """Blocks of a page that run in Octave."""

    page: str
    shown: str

    def objective(self, cache: Path) -> float:
        """Run them; return the value of ``shown``."""
        octave = shutil.which("octave-cli")
        if octave is None:
            raise Missing("GNU Octave is not installed")
        code = f"{blocks(self.page, 'matlab')}\nprintf('\\n%.9g\\n', {self.shown});\n"
        return printed_by([octave, "--no-gui", "--quiet", "--norc", "--path", str(HERE), "--eval", code])


@dataclass(frozen=True)
class Check:
    """What runs, and the objective that the page or the table of the comparison names."""

    code: Script | Python | Matlab
    expected: float
    tolerance: float


CHECKS = {
    "drake": Check(Script("drake-ipopt", "T5@25"), 0.6728, 1e-3),
    "crocoddyl": Check(Script("crocoddyl", "T4"), 1090.8, 1.0),
    "dymos": Check(Python("dymos.md", "dymos", "problem.get_val('traj.phase0.timeseries.time')[-1, 0]"), 1.8036, 1e-3),
    "optimtraj": Check(Matlab("optimtraj.md", "soln.info.objVal"), 58.808, 1e-3),
    "gpops": Check(Matlab("gpops.md", "output.result.objective"), 4.0, 1e-6),
}


def main() -> int:
    """Run what is named, or all; return the number of wrong answers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tools", nargs="*", help=f"of {', '.join(CHECKS)}; all by default")
    parser.add_argument("--cache", type=Path, default=DEFAULT_CACHE)
    options = parser.parse_args()
    wrong = 0
    for name in options.tools or CHECKS:
        check = CHECKS[name]
        try:
            objective = check.code.objective(options.cache.resolve())
        except Missing as reason:
            print(f"{name}: left out, {reason}", flush=True)
            continue
        right = abs(objective - check.expected) <= check.tolerance
        wrong += not right
        expected = "as expected" if right else f"WRONG, expected {check.expected}"
        print(f"{name}: objective {objective:.6g}, {expected}", flush=True)
    return wrong


if __name__ == "__main__":
    raise SystemExit(main())
