"""The jobs of an array share a folder: each plans its part of a study, then what the others have left."""

import subprocess
import sys
import tempfile
from pathlib import Path

import robotraj as rt

STUDY = """
import robotraj as rt

arm = rt.load("two_link_arm")


def make(case):
    start, end = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[case["reach"], 0.5], v=0)
    return rt.Phase(arm, 6.0, start, end, rt.Effort())


cases = [{"reach": 1.0 + 0.05 * i} for i in range(6)]
"""

folder = Path(tempfile.mkdtemp())
(folder / "study.py").write_text(STUDY)
parts = [
    [sys.executable, "-m", "robotraj", "sweep", "study.py", "--store", "reaches", "--part", f"{number}/2"]
    for number in range(2)
]
# A scheduler starts these on its machines: SLURM, Kubernetes, GNU parallel.
for job in [subprocess.Popen(part, cwd=folder) for part in parts]:
    assert job.wait() == 0
study = rt.Study(folder / "reaches")
print(study)
assert len(study) == 6 and not study.missing
arm = rt.load("two_link_arm")
print(rt.plan(rt.Phase(arm, 6.0, rt.State(q=[0.0, 0.3], v=0), rt.State(q=[1.0, 0.5], v=0), rt.Effort())).objective)
