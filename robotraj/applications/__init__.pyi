"""What is built on ``plan()``: paths and programs, many plans, studies, replanning, problems in files.

Start with ``many/sweep.py``. The room may import every room but ``cli``.
"""

from .many.cheapest import Cheapest, cheapest
from .many.designs.codesign import Codesign, codesign
from .many.designs.pareto import Front, FrontPoint, pareto
from .many.failure import Failure
from .many.libraries.library import Library, library
from .many.multistart import Multistart, Optimum, multistart
from .many.sweep import sweep
from .many.workers import Interrupted
from .paths.joint_path import as_path
from .paths.on_path import override, stop_on_path
from .paths.retime import retime
from .paths.shared_cell import SharedCell, share_cell
from .problem_files.load import ProblemFile
from .replanning.driven import driven
from .replanning.replan import Replan

__all__ = [
    "Cheapest",
    "Codesign",
    "Failure",
    "Front",
    "FrontPoint",
    "Interrupted",
    "Library",
    "Multistart",
    "Optimum",
    "ProblemFile",
    "Replan",
    "SharedCell",
    "as_path",
    "cheapest",
    "codesign",
    "driven",
    "library",
    "multistart",
    "override",
    "pareto",
    "retime",
    "share_cell",
    "stop_on_path",
    "sweep",
]
