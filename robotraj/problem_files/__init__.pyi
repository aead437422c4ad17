"""Problems in TOML: files that say what a Python script would, and messages that name line and key.

Start with ``load.py``. The room may import every room but ``cli``.
"""

from .load import load_problem
from .problem_file import ProblemFile

__all__ = [
    "ProblemFile",
    "load_problem",
]
