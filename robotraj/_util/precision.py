"""What counts as met, as the same and as round-off: one number each for every room that plans.

Code that checks a plan has its own numbers, since a judge shares nothing with what it judges.
"""

from __future__ import annotations

MET = 1e-6
"""Violation relative to its bound, distance [m] or difference that is allowed: a hundredth of the allowed errors."""
SAME = 1e-9
"""Relative difference of values that are the same, but computed in two ways."""
ROUND_OFF = 1e-12
"""Relative size of what sums of thousands of terms leave of zero, some thousand times the precision of a number."""
DIFFERENCE = 1e-4
"""Step of central differences relative to the size of the argument, about the fourth root of the precision."""
SAMPLES = 101
"""Number of points of a motion at equal steps of time, where it is compared or interpolated."""
