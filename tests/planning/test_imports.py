"""A plan that succeeds imports neither the search for the cause of a failure nor what else it does not need."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import sys
import robotraj as rt

block = rt.Phase(rt.load("block"), 3.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort())
assert rt.plan(block, progress=False).proof.holds
print(*sys.modules)
"""
UNNEEDED = (
    "numpy.polynomial",
    "robotraj.fixed_mesh.restarts",
    "robotraj.fixed_mesh.diagnosis.elastic",
    "robotraj.fixed_mesh.diagnosis.explain",
    "robotraj.fixed_mesh.diagnosis.unreached_ends",
)


def test_a_proved_plan_in_a_fresh_process_imports_no_diagnosis() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True, timeout=120)
    assert set(UNNEEDED).isdisjoint(done.stdout.split())
