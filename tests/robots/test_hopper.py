"""The hopper pushes itself up by its leg."""

from __future__ import annotations

import numpy as np
from pinned import Planar

G = 9.81


def test_the_hopper_pushes_itself_up_by_its_leg():
    robot = Planar("hopper")
    q = robot.vector({"leg": 0.5})
    a = robot.pinned("foot", q, np.zeros(5), robot.vector({"leg": 100.0}))
    np.testing.assert_allclose(a, [0, 100 / 3.2 - G, 0, 0, 100 / 3.2 - G], atol=1e-12)
    np.testing.assert_allclose(
        robot.place("foot", robot.vector({"leg": 0.5, "hip": np.pi / 6})), [-0.25, -0.25 * 3**0.5]
    )
