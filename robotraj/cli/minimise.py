"""What ``robotraj plan`` minimises."""

from __future__ import annotations

from enum import Enum


class Minimise(str, Enum):
    """The objectives that ``robotraj plan`` knows by name."""

    effort = "effort"
    duration = "duration"
