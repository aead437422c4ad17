"""A shortage of memory is one clear error, whichever library meets it."""

from __future__ import annotations

import subprocess
import sys

import pytest

import robotraj as rt
from robotraj._util.errors import OutOfMemory
from robotraj.fixed_mesh.diagnosis.memory import is_shortage, shortage_named

SHORT = """
import resource, sys
from pathlib import Path
import robotraj as rt
robot = rt.load("panda")
end = robot.neutral.copy()
end[0] += 0.5
phase = rt.Phase(robot, 2.0, rt.State(q=robot.neutral, v=0), rt.State(q=end, v=0), rt.Effort())
solver = {"ours": rt.InteriorPoint(fallback=None), "ipopt": rt.Ipopt()}[sys.argv[1]]
plan = lambda intervals: rt.plan(phase, rt.Mesh(intervals), solver=solver, check=False, progress=False)
assert plan(5).success
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 2**24, used + 2**24))
try:
    plan(3000)
except rt.RobotrajError as error:
    print(type(error).__name__, isinstance(error, MemoryError), error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the limit is one of Linux")
@pytest.mark.parametrize("solver", ["ours", "ipopt"])
def test_a_plan_without_memory_ends_with_a_clear_error(solver: str) -> None:
    found = subprocess.run([sys.executable, "-c", SHORT, solver], capture_output=True, text=True, timeout=300)
    assert found.returncode == 0, found.stderr[-2000:]
    assert found.stdout.startswith("OutOfMemory True No memory was left; the process holds ")


def test_errors_that_a_shortage_caused_are_told_from_others() -> None:
    with pytest.raises(OutOfMemory), shortage_named():
        raise RuntimeError("std::bad_alloc")
    with pytest.raises(OutOfMemory), shortage_named():
        try:
            raise MemoryError
        except MemoryError as error:
            raise SystemError("returned a result with an exception set") from error
    with pytest.raises(rt.InputError), shortage_named():
        raise rt.InputError("another")
    assert not is_shortage(None) and not is_shortage(ValueError("no memory of it"))
