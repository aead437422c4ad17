"""Colours of curves, traces, contacts and solutions, the same in the view and in the charts."""

from __future__ import annotations

RGB = (
    (0.00, 0.45, 0.76),
    (0.84, 0.37, 0.00),
    (0.00, 0.56, 0.41),
    (0.71, 0.34, 0.60),
    (0.60, 0.44, 0.00),
    (0.44, 0.43, 0.90),
    (0.42, 0.47, 0.53),
)
"""Red, green and blue in [0, 1].

They stay apart for the colour-blind, beside dashes, after Okabe and Ito, Color universal design (2008). The contrast of
each is at least 3 on the light and on the dark page.
"""


def rgb(number: int) -> tuple[float, float, float]:
    """Return the colour of a number, modulo the number of colours."""
    return RGB[number % len(RGB)]


def css(number: int) -> str:
    """Return the colour of a trace or contact in CSS notation."""
    return "rgb({}, {}, {})".format(*(round(255 * part) for part in rgb(number)))


def palette() -> list[str]:
    """Return all colours in CSS notation."""
    return [css(number) for number in range(len(RGB))]
