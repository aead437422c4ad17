"""Gaits: phases and links of walking, running, trotting and jumping robots, written out to plan or to edit."""

from robotraj.gait.feet import feet_of, limb_ends
from robotraj.gait.flight import Flight
from robotraj.gait.mirror import mirror
from robotraj.gait.sequence import Support, Terms, sequence
from robotraj.gait.stand import stand
from robotraj.gait.upright import Upright
from robotraj.gait.walks import jump, run, trot, walk

__all__ = [
    "Flight",
    "Support",
    "Terms",
    "Upright",
    "feet_of",
    "jump",
    "limb_ends",
    "mirror",
    "run",
    "sequence",
    "stand",
    "trot",
    "walk",
]
