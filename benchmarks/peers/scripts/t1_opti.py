"""T1 by hand: the block's acceleration is its force."""

from hermite_simpson import solve
from report import asked

solve(asked("T1"), lambda q, v, u: u)
