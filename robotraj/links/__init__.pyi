"""Links: values that join the ends of phases."""

from robotraj.links.base import BoundLink, Ends, Link
from robotraj.links.continuity import Continuity, Jump
from robotraj.links.linkage import EqualDuration, Linkage, SameParameter
from robotraj.links.periodic import Mirror, Periodic
from robotraj.links.touchdown import Liftoff, Touchdown

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
