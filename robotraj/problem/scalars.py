"""Types of the values of expressions of a point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Scalar: TypeAlias = ca.SX | float
"""A symbol in the NLP, a number in the witness."""

Scalars: TypeAlias = Scalar | Sequence[Scalar] | NDArray[np.float64]
"""One scalar or several, as users write them."""
