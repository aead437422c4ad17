"""Results do not depend on CasADi's plugins that ran before, nor do theirs on robotraj, bit for bit."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import casadi as ca
import pytest

SCRIPT = '''
import hashlib, json, sys
import casadi as ca
import numpy as np

def digest(*arrays):
    return hashlib.sha256(b"".join(np.ascontiguousarray(a, dtype=float).tobytes() for a in arrays)).hexdigest()

def nlp(plugin):
    """Swing a pendulum by multiple shooting, with the structure that fatrop finds by itself."""
    opti, count = ca.Opti(), 15
    states, controls = [], []
    for k in range(count + 1):
        states.append(opti.variable(2))
        if k < count:
            controls.append(opti.variable())
    for k in range(count):
        x, u = states[k], controls[k]
        opti.subject_to(states[k + 1] == x + 0.1 * ca.vertcat(x[1], u - ca.sin(x[0])))
        if k == 0:
            opti.subject_to(x == 0)
        opti.subject_to(opti.bounded(-2, u, 2))
    opti.subject_to(states[-1] == ca.DM([1.0, 0.0]))
    opti.minimize(sum(u**2 for u in controls))
    options = {"print_time": False, "structure_detection": "auto"} if plugin == "fatrop" else {"print_time": False}
    opti.solver(plugin, options, {"print_level": 0})
    return digest(opti.solve().value(opti.x))

def conic(plugin):
    """A linear-quadratic problem of two stages: x0, u0, x1."""
    h, a = ca.DM.eye(5) * 2.0, ca.sparsify(ca.DM([[1, 0.1, 0, -1, 0], [0, 1, 0.1, 0, -1]]))
    stages = {"N": 1, "nx": [2, 2], "nu": [1, 0], "ng": [0, 0]}
    options = {"print_iter": False, "print_header": False} if plugin == "qrqp" else stages
    solver = ca.conic("s", plugin, {"h": h.sparsity(), "a": a.sparsity()}, options)
    return digest(solver(h=h, g=np.arange(5.0), a=a, lba=0, uba=0, lbx=-3, ubx=3)["x"])

def own():
    import robotraj as rt
    ends = rt.State(q=[0, 0], v=0), rt.State(q=[1, np.pi], v=0)
    phase = rt.Phase(rt.load("cartpole"), 2.0, *ends, rt.Effort())
    bits = []
    for solver in (rt.InteriorPoint(), rt.Ipopt()):
        found = rt.plan(phase, mesh=rt.Mesh(10), solver=solver, progress=False)
        bits.append(digest(found.at(found.knots).q, found.at(found.knots).tau))
    return bits

found = {}
for task in sys.argv[1:]:
    found[task] = own() if task == "own" else conic(task) if task in ("qrqp", "hpipm") else nlp(task)
print(json.dumps(found))
'''

PLUGINS = [name for name in ("ipopt", "fatrop") if ca.has_nlpsol(name)]
PLUGINS += [name for name in ("hpipm", "qrqp") if ca.has_conic(name)]


def bits(*tasks: str) -> dict[str, object]:
    """Run tasks in turn in a process of their own."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", SCRIPT, *tasks], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
def test_neither_changes_a_bit_of_the_other() -> None:
    alone = {task: bits(task)[task] for task in ("own", *PLUGINS)}
    assert len(alone) >= 3
    for order in (("own", *PLUGINS), (*PLUGINS, "own"), (*reversed(PLUGINS), "own")):
        assert bits(*order) == {task: alone[task] for task in order}
