"""Winding numbers of surfaces, for many points at little cost.

All terms of a triangle's solid angle are polynomials in the point, of which the coefficients are computed once.
Sources: Van Oosterom and Strackee, The solid angle of a plane triangle, 1983; Jacobson, Kavan and Sorkine-Hornung,
Robust inside-outside segmentation using generalized winding numbers, 2013.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.values import dataclass
from robotraj.robot.meshes.arrays import distinct


@dataclass(frozen=True, eq=False)
class Winding:
    """A surface that winds around points.

    Attributes
    ----------
    middle : ndarray (3,)
        Middle of its corners, from which all else is measured, as coordinates far from 0 lose digits [m].
    corners : ndarray (n, 3)
        Corners that differ, from the middle [m].
    faces : ndarray of int (3, f)
        The corners of each triangle.
    volumes : ndarray (f,)
        Six times the volumes of the triangles and the middle [m^3].
    normals : ndarray (f, 3)
        Twice the areas along the normals [m^2].
    products : ndarray (3, f)
        Products a' b, b' c and c' a of the corners of each triangle [m^2].
    """

    middle: Array
    corners: Array
    faces: NDArray[np.int_]
    volumes: Array
    normals: Array
    products: Array

    @classmethod
    def of(cls, triangles: Array) -> Winding:
        """Return a surface of triangles (f, 3, 3) [m]."""
        points = triangles.reshape(-1, 3)
        middle = points.mean(axis=0)
        first, place = distinct(points)
        corners, faces = points[first] - middle, np.ascontiguousarray(place.reshape(-1, 3).T)
        a, b, c = corners[faces]
        normals = np.cross(b - a, c - a)
        products = np.array([np.einsum("fi,fi->f", *pair) for pair in ((a, b), (b, c), (c, a))])
        return cls(middle, corners, faces, np.einsum("fi,fi->f", a, np.cross(b, c)), normals, products)

    def number(self, point: Array) -> float:
        """Return how often the surface winds around a point (3,) [m]: the sum of the solid angles over 4 pi.

        With the corners a, b, c seen from the point, the tangent of half the solid angle is a' (b x c) over
        abs(a) abs(b) abs(c) + a' b abs(c) + b' c abs(a) + c' a abs(b).
        """
        p = point - self.middle
        away, along, square = self.corners - p, self.corners @ p, float(p @ p)
        lengths = np.sqrt(np.einsum("ni,ni->n", away, away))
        a, b, c = lengths[self.faces]
        along_a, along_b, along_c = along[self.faces]
        ab, bc, ca = self.products + square
        below = a * b * c + (ab - along_a - along_b) * c + (bc - along_b - along_c) * a + (ca - along_c - along_a) * b
        return float(np.sum(np.arctan2(self.volumes - self.normals @ p, below))) / (2.0 * np.pi)
