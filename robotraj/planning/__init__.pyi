"""From a problem to a checked solution: solve, refine, restart; continuation, many starts, sweeps.

Start with ``plan.py``. The room may import every room but ``cli``.
"""

from .compilation import Compilation, precompile
from .continuation import ContinuationStep, tightening
from .kinematic import Kinematic
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
from .plan import plan
from .problem_files.problem_file import ProblemFile
from .replanning.driven import driven
from .replanning.replan import Replan
from .settings import Restarts, Settings

__all__ = [
    "Codesign",
    "Compilation",
    "ContinuationStep",
    "Failure",
    "Front",
    "FrontPoint",
    "Interrupted",
    "Kinematic",
    "Library",
    "Multistart",
    "Optimum",
    "ProblemFile",
    "Replan",
    "Restarts",
    "Settings",
    "SharedCell",
    "as_path",
    "codesign",
    "driven",
    "library",
    "multistart",
    "override",
    "plan",
    "pareto",
    "precompile",
    "retime",
    "share_cell",
    "stop_on_path",
    "sweep",
    "tightening",
]
