"""Gaits: phases and links of robots that walk, run, trot, crawl and jump, written out to plan or to edit.

Start with ``walks.py``. The room may import ``guess``, ``problem`` and what lies below.
"""

from robotraj.gait.bounds.own_sides import OwnSides
from robotraj.gait.bounds.upright import Upright
from robotraj.gait.crawls import crawl
from robotraj.gait.feet import feet_of, limb_ends
from robotraj.gait.flight import Flight
from robotraj.gait.jumps import jump
from robotraj.gait.mirroring.mirror import mirror
from robotraj.gait.phase_sequence import sequence
from robotraj.gait.posture import gait_objective, posture_objective
from robotraj.gait.standing import stand
from robotraj.gait.stepping.footholds import steps
from robotraj.gait.stepping.joining import start, stop
from robotraj.gait.stepping.over_steps import gap, stairs
from robotraj.gait.stepping.rest_to_rest import sidestep, start_stop, turn
from robotraj.gait.supports import GaitTerms, Support
from robotraj.gait.walks import run, trot, walk

__all__ = [
    "Flight",
    "Support",
    "GaitTerms",
    "OwnSides",
    "Upright",
    "crawl",
    "feet_of",
    "gap",
    "gait_objective",
    "jump",
    "limb_ends",
    "mirror",
    "posture_objective",
    "run",
    "sequence",
    "sidestep",
    "stairs",
    "stand",
    "start",
    "start_stop",
    "steps",
    "stop",
    "trot",
    "turn",
    "walk",
]
