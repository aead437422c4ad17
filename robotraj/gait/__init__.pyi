"""Gaits: phases and links of robots that walk, run, trot, crawl and jump, written out to plan or to edit.

Start with ``walks.py``. The room may import ``guess``, ``problem`` and what lies below.
"""

from .bounds.own_sides import OwnSides
from .bounds.turning import Turning
from .bounds.upright import Upright
from .contact_orders import orders
from .crawls import crawl
from .feet import feet_of, limb_ends
from .heel_to_toe import heel_to_toe
from .leaping.flips import flip
from .leaping.jumps import jump
from .mirroring.mirror import mirror
from .phase_sequence import Flight, sequence
from .posture import gait_objective, haste, posture_objective
from .standing import stand
from .stepping.footholds import steps
from .stepping.joining import start, stop
from .stepping.over_steps import gap, stairs
from .stepping.rest_to_rest import sidestep, start_stop, turn
from .supports import GaitTerms, Support
from .walks import run, trot, walk

__all__ = [
    "Flight",
    "Support",
    "GaitTerms",
    "OwnSides",
    "Turning",
    "Upright",
    "crawl",
    "feet_of",
    "flip",
    "gap",
    "gait_objective",
    "haste",
    "heel_to_toe",
    "jump",
    "limb_ends",
    "mirror",
    "orders",
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
