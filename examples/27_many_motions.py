"""A study: a table of cases, planned once each into a folder; what failed, what is missing, and how to read it."""

import tempfile
from pathlib import Path

import numpy as np

import robotraj as rt

arm = rt.load("two_link_arm")


def make(case: dict[str, float]) -> rt.Phase:
    """Reach ``case["reach"]`` [rad] with the shoulder within ``case["T"]`` [s]."""
    start, end = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[case["reach"], 0.5], v=0)
    return rt.Phase(arm, case["T"], start, end, rt.Effort(), name="reach")


first = rt.plan(make({"reach": 1.0, "T": 6.0}))
cases = [{"reach": float(reach), "T": T} for reach in np.linspace(1.0, 1.4, 4) for T in (1.0, 6.0)]
folder = Path(tempfile.mkdtemp()) / "reaches"
study = rt.sweep(make, cases, store=folder, time_limit=20)
print(study)
for row in study.failures.to_pylist():
    print(f"reach {row['case_reach']:.2f} rad in {row['case_T']:g} s: {row['message'][:80]}")

# The same call plans what is missing: nothing here. New cases would be planned, known ones would not.
again = rt.sweep(make, cases, store=folder, time_limit=20)
assert len(again) == len(cases) and not again.missing
solved = again.figures.filter(again.figures["success"])
print("least effort:", min(solved["objective"].to_pylist()), "seconds in all:", sum(solved["seconds"].to_pylist()))
