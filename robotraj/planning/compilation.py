"""precompile(): compile the C libraries of a problem before it is planned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj._util.printing import OneLine, wrapped
from robotraj._util.values import dataclass
from robotraj.guess.default import default_guess
from robotraj.native.engines.compiled import Compiled
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.transcription.schemes.mesh import Mesh
from robotraj.transcription.smoothness.smoothing import SMOOTHING
from robotraj.transcription.transcribe import transcribe


@dataclass(frozen=True)
class Compilation(OneLine):
    """Result of compiling a problem.

    Attributes
    ----------
    functions : int
        Number of point functions that are large enough to be compiled.
    new : int
        Number of those that were not in the cache before.
    seconds : float
        Time spent in the compiler [s].
    folder : Path
        Folder of the cache.
    """

    functions: int
    new: int
    seconds: float
    folder: Path

    def __str__(self) -> str:
        if not self.functions:
            text = "nothing to compile: every point function is too small, or belongs to a shooting scheme"
        else:
            text = f"{self.new} of {self.functions} point functions compiled in {self.seconds:.1f} s into {self.folder}"
        return "\n".join(wrapped(text))


def precompile(
    problem: Problem | Phase, mesh: Mesh | Sequence[Mesh] | None = None, engine: Compiled | None = None
) -> Compilation:
    """Compile the point functions of a problem into the cache, so that no plan of it waits for the compiler.

    Every plan of phases with the same equations uses these libraries. Robot, dynamics, contacts, objective and path
    constraints must be the same, and so must the choice of free duration and parameters. Start, goal, limits, number of
    intervals and order of the scheme may differ.

    Parameters
    ----------
    problem : Problem or Phase
    mesh : Mesh or sequence of Mesh, optional
        As for ``rt.plan``.
    engine : Compiled, optional
        ``rt.engines.Compiled()`` by default. The call returns when all libraries are compiled, whatever its ``wait``.

    Returns
    -------
    Compilation

    Raises
    ------
    InputError
        There is no compiler on this machine, or the problem cannot be transcribed.
    """
    if isinstance(problem, Phase):
        problem = Problem([problem])
    if not isinstance(problem, Problem):
        raise InputError(f"rt.planning.precompile takes an rt.Problem or an rt.Phase; got {type(problem).__name__}.")
    if engine is not None and not isinstance(engine, Compiled):
        raise InputError(f"engine= of rt.planning.precompile is an rt.engines.Compiled(); got {engine!r}.")
    engine = replace(engine or Compiled(), wait=True)
    # A plan without a mesh smooths its torques, as the settings do.
    smoothing = SMOOTHING if mesh is None else 0.0
    nlp = transcribe(problem, mesh or Mesh(), default_guess(problem), engine, smoothing=smoothing)
    cache = engine.open_cache()
    before = set(cache.libraries())
    seconds = nlp.functions.preparing
    used = engine.libraries(nlp.point_functions)
    return Compilation(len(used), len(used - before), seconds, cache.folder)
