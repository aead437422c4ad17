"""The compared tools: robotraj in its variants, and its peers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace


@dataclass(frozen=True)
class Tool:
    """A tool as it is run.

    Attributes
    ----------
    title : str
    script : str
        In ``scripts``.
    environment : str or None
        Of ``environments.py``; None is the interpreter that runs the comparison.
    variables : mapping
        Handed to the script.
    cached : bool
        Whether compiled functions are kept from one run to the next; a first run, which is not measured, fills the
        cache. Else every run has an empty one.
    slow : bool
        Repeated less often.
    cannot : mapping of str to str
        Tasks that it cannot express or that are not written for it, and why.
    largest : int
        Largest number of intervals; larger meshes take minutes.
    """

    title: str
    script: str
    environment: str | None = None
    variables: Mapping[str, str] = field(default_factory=dict)
    cached: bool = False
    slow: bool = False
    cannot: Mapping[str, str] = field(default_factory=dict)
    largest: int = 400


def _robotraj(variant: str, cached: bool = False, **variables: str) -> Tool:
    return Tool(f"robotraj{variant}", "plan_robotraj.py", None, variables, cached, largest=1600)


ONE = "not run: one start reaches the best known"


def _several(starts: int) -> Tool:
    tool = _robotraj(f", interior point, {starts} starts", PEERS_STARTS=str(starts))
    return replace(tool, cannot={"T1": ONE, "T4": ONE, "T5": ONE})


FREE = "cannot: free duration"
PAPER = "not tried: its equations would have to be written out in SymPy"
TOOLS: dict[str, Tool] = {
    "robotraj": _robotraj(""),
    "robotraj-compiled": _robotraj(", compiled", True, PEERS_ENGINE="engines.Compiled"),
    "robotraj-ipopt": _robotraj(
        ", IPOPT, virtual machine", PEERS_SOLVER="Ipopt", PEERS_ENGINE="engines.VirtualMachine"
    ),
    "robotraj-interior-point": _robotraj(
        ", interior point",
        PEERS_SOLVER="InteriorPoint",
        PEERS_ENGINE="engines.Native",
        PEERS_INTERVAL_LIMITS="interval_limits.ConstraintGeneration",
    ),
    "robotraj-bernstein": _robotraj(
        ", interior point, Bernstein bounds",
        PEERS_SOLVER="InteriorPoint",
        PEERS_ENGINE="engines.Native",
        PEERS_INTERVAL_LIMITS="interval_limits.BernsteinBounds",
    ),
    "robotraj-bernstein-compiled": _robotraj(
        ", interior point, Bernstein bounds, compiled",
        True,
        PEERS_SOLVER="InteriorPoint",
        PEERS_ENGINE="engines.Compiled",
        PEERS_INTERVAL_LIMITS="interval_limits.BernsteinBounds",
    ),
    "robotraj-starts": _several(10),
    "robotraj-starts-20": _several(20),
    "robotraj-ends": replace(
        _robotraj(
            ", interior point, Bernstein bounds, twice as many intervals at Chebyshev knots",
            PEERS_SOLVER="InteriorPoint",
            PEERS_ENGINE="engines.Native",
            PEERS_INTERVAL_LIMITS="interval_limits.BernsteinBounds",
            PEERS_MESH="Chebyshev",
        ),
        cannot=dict.fromkeys(("T1", "T2", "T3", "T4"), "not run: a mesh for an arm's minimum time"),
    ),
    "robotraj-proven": _robotraj(", proved by default", PEERS_MESH="open"),
    "by-hand": Tool("by hand, inverse dynamics", "inverse_by_hand.py"),
    "opti": Tool("CasADi Opti", "opti_forward.py", slow=True, largest=50),
    "drake-ipopt": Tool(
        "Drake, IPOPT", "drake_collocation.py", "drake", {"PEERS_SOLVER": "ipopt"}, slow=True, largest=200
    ),
    "drake-snopt": Tool(
        "Drake, SNOPT", "drake_collocation.py", "drake", {"PEERS_SOLVER": "snopt"}, slow=True, largest=50
    ),
    "crocoddyl": Tool("Crocoddyl", "crocoddyl_shooting.py", "crocoddyl", cannot={"T1": FREE, "T5": FREE}),
    "dymos": Tool("Dymos", "dymos_lobatto.py", "dymos", slow=True, largest=50),
    "opty": Tool(
        "opty, NumPy", "opty_midpoint.py", "opty", {"PEERS_BACKEND": "numpy"}, cannot={"T4": PAPER, "T5": PAPER}
    ),
    "opty-compiled": Tool(
        "opty, compiled",
        "opty_midpoint.py",
        "opty",
        {"PEERS_BACKEND": "cython"},
        slow=True,
        cannot={"T4": PAPER, "T5": PAPER},
    ),
}
