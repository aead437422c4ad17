"""Types of expressions of a point and of their values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from robotraj.dynamics.point import RobotPoint

Scalar: TypeAlias = ca.SX | float
"""A symbol in the NLP, a number in the witness."""

Scalars: TypeAlias = Scalar | Sequence[Scalar] | NDArray[np.float64]
"""One scalar or several, as users write them."""

PointExpression: TypeAlias = "Callable[[RobotPoint], Scalars]"
"""A user's function of a point. The points of a System are of the class ``Point``, which has no joints and frames."""

EndExpression: TypeAlias = "Callable[[RobotPoint, RobotPoint], Scalar]"
"""A user's function of the start and the end of a phase."""
