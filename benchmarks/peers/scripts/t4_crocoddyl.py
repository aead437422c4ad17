"""T4 with Crocoddyl."""

from crocoddyl_shooting import solve
from report import asked

solve(asked("T4"))
