"""Objectives of ``robotraj plan``."""

from __future__ import annotations

from enum import Enum


class Minimise(str, Enum):
    """The objectives of ``robotraj plan``."""

    effort = "effort"
    duration = "duration"
