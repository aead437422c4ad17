"""The indirect view of a direct solution: costates, necessary conditions, Pontryagin's equations."""

from robotraj.indirect.arcs import Arc, Side
from robotraj.indirect.conditions import conditions
from robotraj.indirect.costates import Costates, CostateSample, PhaseCostates, costates
from robotraj.indirect.junctions import cut_at_junctions
from robotraj.indirect.polish import polish
from robotraj.indirect.polished import Polished, PolishFailed
from robotraj.indirect.report import Condition, ConditionsReport

__all__ = [
    "Arc",
    "Condition",
    "ConditionsReport",
    "CostateSample",
    "Costates",
    "PhaseCostates",
    "PolishFailed",
    "Polished",
    "Side",
    "conditions",
    "costates",
    "cut_at_junctions",
    "polish",
]
