"""T4 with Drake."""

from drake_collocation import solve
from report import asked

solve(asked("T4"))
