"""Colours of traces and contacts: one for each, the same in the view and in the charts."""

from __future__ import annotations

RGB = (
    (0.84, 0.15, 0.36),
    (0.05, 0.55, 0.56),
    (0.93, 0.55, 0.08),
    (0.35, 0.30, 0.75),
    (0.10, 0.45, 0.82),
    (0.55, 0.42, 0.20),
)
"""Red, green and blue in [0, 1]."""


def rgb(number: int) -> tuple[float, float, float]:
    """Return the colour of a trace or contact by its number, modulo the number of colours."""
    return RGB[number % len(RGB)]


def css(number: int) -> str:
    """Return the colour of a trace or contact in CSS notation."""
    return "rgb({}, {}, {})".format(*(round(255 * part) for part in rgb(number)))
