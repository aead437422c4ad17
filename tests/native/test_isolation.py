"""Plans and the solvers that CasADi ships do not disturb each other."""

from __future__ import annotations

import subprocess
import sys

from robotraj.native.build import load_native

CASADI = """
import casadi as ca
x, u, y = (ca.SX.sym(name) for name in "xuy")
nlp = {"x": ca.vertcat(x, u, y), "f": ca.exp(u) + y**4, "g": ca.vertcat(y - x - u, x - 1)}
for name, options in {
    "fatrop": {"structure_detection": "auto", "equality": [True, True], "fatrop": {"print_level": 0}},
    "ipopt": {"ipopt": {"print_level": 0}},
}.items():
    solve = ca.nlpsol("solve", name, nlp, {"expand": True, "print_time": False} | options)
    print("casadi", name, float(solve(lbg=0, ubg=0)["f"]).hex())
"""
PLAN = """
import robotraj as rt
ends = rt.State(q=[0, -1, 1, 0, 0, 0], v=0), rt.State(q=[1, -0.5, 0.5, 0, 0, 0], v=0)
phase = rt.Phase(rt.load("ur5"), 1.0, *ends, rt.Effort())
plan = rt.plan(phase, rt.Mesh(8), solver=rt.InteriorPoint(fallback=None), progress=False)
print("plan", plan.iterations, float(plan.objective).hex())
"""


def printed(script: str) -> set[str]:
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return {line for line in run.stdout.splitlines() if line.startswith(("plan", "casadi"))}


def test_neither_casadis_plugins_nor_plans_depend_on_which_ran_first() -> None:
    alone = printed(CASADI) | printed(PLAN)
    assert len(alone) == 3
    assert printed(PLAN + CASADI) == printed(CASADI + PLAN) == alone


def test_the_module_exports_its_entry_and_no_symbol_of_another_library() -> None:
    symbols = subprocess.run(
        ["nm", "-D", "--defined-only", load_native().__file__], capture_output=True, text=True, check=True
    ).stdout
    assert "PyInit__native" in symbols
    assert not [line for line in symbols.splitlines() if "fatrop" in line or "blasfeo" in line.lower()]
