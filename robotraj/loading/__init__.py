"""From a name, a file or a model to what a Robot is made of. Layer 0."""

from robotraj.loading.assembly import assemble, units
from robotraj.loading.catalogue import catalogue
from robotraj.loading.configuration import as_vector
from robotraj.loading.entry import Entry
from robotraj.loading.geometry import Geometry, NoGeometry
from robotraj.loading.limits import Limits
from robotraj.loading.source import describe
from robotraj.loading.table import table

__all__ = [
    "Entry",
    "Geometry",
    "Limits",
    "NoGeometry",
    "as_vector",
    "assemble",
    "catalogue",
    "describe",
    "table",
    "units",
]
