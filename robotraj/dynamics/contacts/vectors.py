"""Products of vectors given as lists of 3 with entries that are floats, CasADi symbols or CasADi numbers."""

from __future__ import annotations

from collections.abc import Sequence

from robotraj.dynamics.variable import Column, Scalar


def dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """Scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    """Vector product a x b."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def add(*vectors: Column | Sequence[Scalar]) -> list[Scalar]:
    """Sum of vectors."""
    return [sum(vector[i] for vector in vectors[1:]) + vectors[0][i] for i in range(3)]


def subtract(a: Sequence[Scalar], b: Sequence[Scalar]) -> list[Scalar]:
    """Difference a - b."""
    return [a[i] - b[i] for i in range(3)]


def scale(factor: Scalar, vector: Sequence[Scalar]) -> list[Scalar]:
    """Multiple of a vector."""
    return [factor * vector[i] for i in range(3)]


def turned(rotation: Column, vector: Sequence[float]) -> list[Scalar]:
    """Components in world axes of a vector fixed in a frame, R s; zero entries of s add no terms to the graph."""
    return [sum(rotation[i, j] * vector[j] for j in range(3) if vector[j] != 0.0) for i in range(3)]
