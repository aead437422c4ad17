"""T1 with Drake: the block as a linear system."""

import numpy as np
from drake_collocation import solve
from pydrake.systems.primitives import LinearSystem
from report import asked

block = LinearSystem(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.eye(2), np.zeros((2, 1)))
solve(asked("T1"), block)
