"""Links: values that join the ends of phases."""

from .base import BoundLink, Ends, Link
from .continuity import Continuity, Jump
from .linkage import EqualDuration, Linkage, SameParameter
from .periodic import Mirror, Periodic
from .touchdown import Liftoff, Touchdown

__all__ = [
    "BoundLink",
    "Continuity",
    "Ends",
    "EqualDuration",
    "Jump",
    "Liftoff",
    "Link",
    "Linkage",
    "Mirror",
    "Periodic",
    "SameParameter",
    "Touchdown",
]
