"""Kelly 2017, section 8 and appendix E: the five-link biped by balances of angular momentum, and its joints' names.

Absolute angles, counter-clockwise from upright: stance tibia, stance femur, torso, swing femur, swing tibia.
"""

from __future__ import annotations

import numpy as np

G = 9.81
MASS = np.array([3.2, 6.8, 20.0, 6.8, 3.2])
INERTIA = np.array([0.93, 1.08, 2.22, 1.08, 0.93])
LENGTH = np.array([0.4, 0.4, 0.625, 0.4, 0.4])
SIGN = np.array([1, 1, 1, -1, -1])
TORSO = {"five_link": 0.625 - 0.2, "five_link_table": 0.2}
BALANCES = [(0, [0, 1, 2, 3, 4]), (1, [1, 2, 3, 4]), (2, [2, 3, 4]), (2, [3, 4]), (4, [4])]
BEFORE = [(5, [0, 1, 2, 3, 4]), (4, [0, 1, 2, 3]), (2, [0, 1, 2]), (2, [0, 1]), (1, [0])]


def five_link_map(stance: str) -> np.ndarray:
    """Return A of (root_pitch, left_hip, left_knee, right_hip, right_knee) = A q, q the absolute angles q1 to q5."""
    pitch, hip, knee = [0, 0, -1, 0, 0], [0, -1, 1, 0, 0], [-1, 1, 0, 0, 0]
    other_hip, other_knee = [0, 0, 1, -1, 0], [0, 0, 0, 1, -1]
    legs = [hip, knee, other_hip, other_knee] if stance == "left" else [other_hip, other_knee, hip, knee]
    return np.array([pitch, *legs], dtype=float)


def five_link_torques(u: np.ndarray, stance: str) -> np.ndarray:
    """Torques of the joints as the URDF names them, from the case's u2 to u5."""
    stood, swung = [u[1], u[0]], [-u[2], -u[3]]
    return np.array([0, 0, 0, *(stood + swung if stance == "left" else swung + stood)])


def chain(torso: float) -> tuple[np.ndarray, np.ndarray]:
    """Points P0 to P5 and centres G1 to G5 as sums over the unit vectors along the links."""
    along = np.diag(LENGTH)
    p1, p2 = along[0], along[0] + along[1]
    p4 = p2 + along[3]
    points = np.array([np.zeros(5), p1, p2, p2 + along[2], p4, p4 + along[4]])
    unit = np.eye(5)
    centres = [p1 - 0.128 * unit[0], p2 - 0.163 * unit[1], p2 + torso * unit[2], p2 + 0.163 * unit[3]]
    return points, np.array([*centres, p4 + 0.128 * unit[4]])


def along_links(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors along the links and their derivatives by the angles, (5, 2) each."""
    return (SIGN * [-np.sin(q), np.cos(q)]).T, (SIGN * [-np.cos(q), -np.sin(q)]).T


def momentum(q, torso, balances):
    """Matrices of the balances: A dq is the angular momentum, A ddq = B dq^2 + g + u its change."""
    points, centres = chain(torso)
    e, de = along_links(q)
    a, b, g = np.zeros((5, 5)), np.zeros((5, 5)), np.zeros(5)
    for row, (about, links) in enumerate(balances):
        for i in links:
            arm = (centres[i] - points[about]) @ e
            turn = np.array([-arm[1], arm[0]]) * MASS[i]
            a[row] += centres[i] * (de @ turn)
            b[row] += centres[i] * (e @ turn)
            a[row, i] += INERTIA[i]
            g[row] -= G * turn[1]
    return a, b, g
