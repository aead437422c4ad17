"""The solved cases of a folder as a library of motions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast, overload

from robotraj._util.errors import InputError
from robotraj.applications.many.libraries.library import Library
from robotraj.applications.studies.cases import Case
from robotraj.applications.studies.rows import CASE
from robotraj.applications.studies.store import Store
from robotraj.problem.phase import Phase
from robotraj.problem.problem import Problem
from robotraj.solution.solution import Solution
from robotraj.solution.storage.load import load_solution


class StoredSolutions(Sequence["Solution"]):
    """Solutions of a folder, read when they are asked for and kept from then on.

    Parameters
    ----------
    store : Store
    keys : sequence of str
    problems : sequence of callable
        Each returns the problem of a solution.
    """

    def __init__(self, store: Store, keys: Sequence[str], problems: Sequence[Callable[[], Problem | Phase]]) -> None:
        self._store, self._keys, self._problems = store, keys, problems
        self._known: dict[int, Solution] = {}

    def __len__(self) -> int:
        return len(self._keys)

    @overload
    def __getitem__(self, number: int) -> Solution: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[Solution]: ...
    def __getitem__(self, number: int | slice) -> Solution | Sequence[Solution]:
        if isinstance(number, slice):
            return [self[i] for i in range(*number.indices(len(self)))]
        at = range(len(self))[number]
        if at not in self._known:
            self._known[at] = load_solution(self._store.solution(self._keys[at]), self._problems[at]())
        return self._known[at]


def stored_library(store: Store, make: Callable[[Any], Problem | Phase] | None) -> Library:
    """Return the library of a folder; see ``Study.library``."""
    if make is None:
        raise InputError("A folder keeps no function: give the one of the study, rt.Study(folder).library(make).")
    names = [name for name in store.columns() if name.startswith(CASE)]
    rows = store.table(["key", *(["success"] if names else []), *names]).to_pylist()
    solved = [row for row in rows if row.get("success")]
    if not solved:
        raise InputError(f"No case of {str(store.folder)!r} was solved; study.failures has the reasons.")
    if not store.solution(solved[0]["key"]).exists():
        raise InputError('A library needs whole solutions: rt.sweep(..., keep="all") keeps them.')
    words = [name.removeprefix(CASE) for name in names if isinstance(solved[0][name], str)]
    if words:
        raise InputError(f"Cases of a library are numbers, which have distances; {words[0]!r} is a word.")
    cases = [{name.removeprefix(CASE): row[name] for name in names} for row in solved]
    problems = [cast("Callable[[], Problem | Phase]", _Posed(make, case)) for case in cases]
    return Library(make, tuple(cases), StoredSolutions(store, [row["key"] for row in solved], problems), ())


class _Posed:
    """The problem of a case, made when it is called."""

    def __init__(self, make: Callable[[Any], Problem | Phase], case: Case) -> None:
        self._make, self._case = make, case

    def __call__(self) -> Problem | Phase:
        return self._make(self._case)
