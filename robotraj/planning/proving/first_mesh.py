"""Meshes of a plan whose mesh was left open: pure functions of what is known before a solve."""

from __future__ import annotations

import numpy as np

from robotraj.transcription.schemes.collocation import Scheme
from robotraj.transcription.schemes.lobatto import HermiteSimpson
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.schemes.radau import RadauIIA

COARSE = 16
"""Intervals of the first mesh: it finds the course of the motion, and what a finer one gains is measured against it."""
SYSTEM = 20
"""The same for systems and robots without a motor at every joint."""
STEP = 6
"""The same for every phase with contacts, most of which are short."""
CROWDING = 0.8
"""How far the knots are drawn to the ends, from 0 for equal intervals to 1."""


STICKING = RadauIIA(3)
"""Scheme of motions with dry friction for the least integral.

Simpson's rule sees a joint that starts and stops inside every interval at its middle alone: the sum that is minimised
then lies percents below the integral. With one more point, and none shared, the two agree.
"""


def graded(count: int, scheme: Scheme | None = None) -> Mesh:
    """Crowd intervals at both ends, where motions start and stop; Hermite-Simpson by default.

    The knots are (1 + (1 - c) x + c sin(pi x / 2)) / 2 at equally spaced x in [-1, 1], c = ``CROWDING``.
    """
    x = np.linspace(-1.0, 1.0, count + 1)
    knots = 0.5 * (1.0 + (1.0 - CROWDING) * x + CROWDING * np.sin(0.5 * np.pi * x))
    knots[0], knots[-1] = 0.0, 1.0
    return Mesh(tuple(knots.tolist()), scheme or HermiteSimpson())
