"""A study is begun, or goes on where it stopped: the cases that are missing are planned."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from os import PathLike
from pathlib import Path
from typing import Any

from robotraj._util.errors import InputError, warn
from robotraj._util.values import dataclass
from robotraj.applications.many.case_limits import CaseLimits
from robotraj.applications.many.workers import sendable
from robotraj.applications.studies.cases import Case, Cases, as_cases
from robotraj.applications.studies.digest import digest_of
from robotraj.applications.studies.dispatch import plan_elsewhere, plan_here
from robotraj.applications.studies.progress import Progress
from robotraj.applications.studies.rows import arrow, own_version
from robotraj.applications.studies.store import Store
from robotraj.applications.studies.study import Study
from robotraj.applications.studies.work import Recipe

KEPT = "trajectory", "all"
AGAIN = 20
"""Cases of other parts after which the store is read again: another process may have planned the next ones."""


@dataclass(frozen=True)
class StudyPart:
    """One of several processes that plan a study without knowing of each other, as of an array of jobs.

    Attributes
    ----------
    number, count : int
        Number of the process, from 0, and the number of all.
    """

    number: int = 0
    count: int = 1

    def __post_init__(self) -> None:
        if not 0 <= self.number < self.count:
            raise InputError(f"part {self.number} of {self.count} is none; parts are 0 to count - 1, such as 3/200.")

    def of(self, cases: Cases, store: Store) -> Iterator[tuple[str, Case]]:
        """Yield the missing cases of this part, then, from the last to the first, those that other parts have left."""
        known, every = store.keys(), list(cases.by_key.items())
        yield from ((key, case) for key, case in every[self.number :: self.count] if key not in known)
        others = [each for n, each in enumerate(reversed(every)) if (len(every) - 1 - n) % self.count != self.number]
        for n, (key, case) in enumerate(others):
            if n % AGAIN == 0:
                known = store.keys()
            if key not in known:
                yield key, case


def study(
    make: Callable[[Case], Any],
    cases: object,
    store: str | PathLike[str],
    *,
    executor: Executor | None = None,
    chain: bool = False,
    keep: str = "trajectory",
    validate: bool = False,
    part: StudyPart | None = None,
    progress: bool | None = None,
    options: Mapping[str, Any],
) -> Study:
    """Plan the cases of a study that are missing, and return it; see ``rt.sweep``."""
    arrow()
    if keep not in KEPT:
        raise InputError(f"keep= is {keep!r}; give 'trajectory', or 'all' for whole solutions beside the rows.")
    chosen = {name: value for name, value in options.items() if value is not None}
    digest = digest_of(make, chosen, keep, validate, own_version(), *(("chain",) if chain else ()))
    every = as_cases(cases, digest)
    folder = Store(Path(store), create=True)
    folder.begin(every, {"digest": digest, "options": str(chosen), "version": own_version(), "keep": keep})
    limits = CaseLimits(chosen.get("time_limit"), chosen.get("memory_limit"))
    first = next(iter(every.by_key.items()))
    columns = Cases(digest, every.names, dict([first]))
    recipe = Recipe(
        make, chosen, folder.folder, keep == "all", validate, limits, columns, every.ranges if chain else None
    )
    sendable(recipe, "make or an option")
    mine = part or StudyPart()
    wanted = mine.of(every, folder)
    known = folder.keys()
    shown = Progress(sum(key not in known for key in list(every.by_key)[mine.number :: mine.count]), progress)
    try:
        if executor is None:
            plan_here(recipe, wanted, folder, shown)
        else:
            lost = plan_elsewhere(recipe, wanted, executor, shown)
            if lost:
                why = next(iter(lost.values()))
                warn(f"{len(lost)} chunks of the study were lost ({why}). Start it again to plan them.")
    finally:
        shown.end()
    return Study(folder.folder, make)
