"""A built-in problem with what solves it."""

from __future__ import annotations

from robotraj._util.values import dataclass
from robotraj.guess.base import InitialGuess
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.schemes.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Demo:
    """A problem with the meshes and the guess that solve it.

    Attributes
    ----------
    problem : Phase or Problem
    meshes : tuple of Mesh or of lists of Mesh
        Solved one after the other, each from the solution before.
    guess : InitialGuess or None
        Of the first mesh; None for the default.
    tolerance : float or None
        Relative error between knots to which the last mesh is refined; None keeps the mesh.
    periods : int
        How often the page shows a gait that closes on itself.
    """

    problem: Phase | Problem
    meshes: tuple[Mesh | list[Mesh], ...]
    guess: InitialGuess | None = None
    tolerance: float | None = None
    periods: int = 1
