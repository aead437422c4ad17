"""``Study``: the cases of a folder, what was planned of them, and what is missing."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.printing import OneLine
from robotraj.applications.studies.rows import CASE, CURVES, KNOTS, arrow
from robotraj.applications.studies.store import MOTION, Store

if TYPE_CHECKING:
    import pyarrow as pa
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from robotraj.applications.many.libraries.library import Library
    from robotraj.applications.studies.cases import Case
    from robotraj.applications.studies.regression import Regressions
    from robotraj.problem.phase import Phase
    from robotraj.problem.problem import Problem
    from robotraj.solution.solution import Solution


class Study(OneLine):
    """Cases of one problem, planned once each and kept in a folder.

    Parameters
    ----------
    folder : path
        Folder that ``rt.sweep(make, cases, store=folder)`` wrote.
    make : callable, optional
        The function of the study, for ``library`` and ``validate``. A folder keeps no function.

    Raises
    ------
    InputError
        There is no such study, or pyarrow is not installed.
    """

    def __init__(self, folder: str | Path, make: Callable[[Any], Problem | Phase] | None = None) -> None:
        arrow()
        self.store = Store(folder)
        self.make = make

    @property
    def facts(self) -> dict[str, Any]:
        """What the study was begun with: digest, options, version of the package."""
        return self.store.facts()

    @property
    def table(self) -> pa.Table:
        """All rows, one for each case that was planned; ``.to_pandas()``, ``polars.from_arrow`` and DuckDB read it."""
        return self.store.table()

    @property
    def figures(self) -> pa.Table:
        """The rows without messages and motions: key, case, status, objective, duration, seconds ..."""
        table = self.store.figures()
        return table.drop_columns(["message", "conflicts"]) if table.num_rows else table

    @property
    def failures(self) -> pa.Table:
        """The rows of cases without a solution, with their messages."""
        table = self.store.figures()
        return table.filter(_not(table.column("success"))) if table.num_rows else table

    @property
    def missing(self) -> list[Case]:
        """Cases that were not planned yet."""
        known = set(self.store.figures().column("key").to_pylist())
        rows = self.store.cases().to_pylist()
        return [
            {name.removeprefix(CASE): value for name, value in row.items() if name != "key"}
            for row in rows
            if row["key"] not in known
        ]

    def motion(self, key: str) -> dict[str, np.ndarray]:
        """Return the motion of a case: ``t`` (64,) [s], and ``q``, ``v``, ``tau`` (64, n) as 32-bit numbers.

        Raises
        ------
        InputError
            No case has the key, or its problem failed.
        """
        row = self.store.row(key, MOTION)
        if row is None:
            raise unknown_name("case of the study with the key", key, self.store.keys())
        if row["t"] is None:
            raise InputError(f"Case {key!r} has no motion, since its plan failed; see study.failures.")
        curves = {name: np.array(row[name], np.float32) for name in CURVES if row[name] is not None}
        return {"t": np.array(row["t"], np.float32), **{n: c.reshape(KNOTS, -1) for n, c in curves.items()}}

    def solution(self, key: str, problem: Problem | Phase | None = None) -> Solution:
        """Return the whole solution of a case; equations of Systems and expressions come with the problem.

        Raises
        ------
        InputError
            The study keeps motions alone: ``keep="all"`` keeps solutions.
        """
        from robotraj.solution.storage.load import load_solution

        path = self.store.solution(key)
        if not path.exists():
            raise InputError(f'No solution of {key!r} is kept; rt.sweep(..., keep="all") keeps them, see .motion(key).')
        return load_solution(path, problem)

    def validate(self, executor: Executor | None = None) -> pa.Table:
        """Simulate the whole solutions of the study with plain Pinocchio, as ``rt.validate`` does.

        Systems and expressions need the function of the study: ``rt.Study(folder, make)``.

        Parameters
        ----------
        executor : concurrent.futures.Executor, optional
            As of ``rt.sweep``; by default the processes of this machine, where they pay.

        Returns
        -------
        pyarrow.Table
            For each solved case its key, whether it ``passed``, its largest ``drift``, and a ``message`` of failures.

        Raises
        ------
        InputError
            The study keeps motions alone: ``keep="all"`` keeps solutions.
        """
        from robotraj.applications.studies.work import validated

        return validated(self.store, self.make, executor)

    def library(self, make: Callable[[Any], Problem | Phase] | None = None) -> Library:
        """Return a library of the solved cases, whose ``plan`` and ``answer`` start from the nearest one.

        Solutions are read from their files when they are the nearest ones. Cases are compared by their numbers.

        Parameters
        ----------
        make : callable, optional
            The function of the study, where ``rt.Study(folder)`` opened it.

        Raises
        ------
        InputError
            There is no ``make``, the study keeps motions alone, no case was solved, or cases have words.
        """
        from robotraj.applications.studies.stored_library import stored_library

        return stored_library(self.store, make or self.make)

    def plot(self, x: str, y: str = "objective") -> Figure:
        """Draw one column over another, such as ``study.plot("speed", "objective")``; failures are crosses.

        Raises
        ------
        UnknownName
            There is no such column.
        """
        from matplotlib.figure import Figure

        table = self.figures
        names = [name.removeprefix(CASE) for name in table.column_names]
        for name in (x, y):
            if name not in names:
                raise unknown_name("column of the study", name, names)
        values = {n: table.column(table.column_names[names.index(n)]).to_numpy(zero_copy_only=False) for n in (x, y)}
        good = table.column("success").to_numpy(zero_copy_only=False).astype(bool)
        figure = Figure(layout="constrained")
        axes = figure.add_subplot(xlabel=x, ylabel=y)
        axes.plot(values[x][good], values[y][good], "o", markersize=3)
        for value in values[x][~good]:
            axes.axvline(value, color="0.85", linewidth=0.5, zorder=0)
        return figure

    def to_lerobot(
        self,
        folder: str | Path,
        rate: int = 50,
        *,
        action: str = "tau",
        task: str = "move",
        robot_type: str | None = None,
    ) -> Path:
        """Write the proved motions as a LeRobot data set of layout 3.0, one episode a case.

        ``LeRobotDataset("name", root=folder)`` reads it. ``observation.state`` has q and v, in the order of the rows.

        Parameters
        ----------
        folder : path
            A new folder.
        rate : int
            Frames a second.
        action : str
            ``"tau"`` [N m, N], or ``"q"`` for the positions of the next frame.
        task : str
            What the robot does, in words.
        robot_type : str, optional
            Name of the robot.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            The folder is not empty, an option has another value, or no case has a motion.
        """
        from robotraj.applications.studies.data_sets.lerobot import write_lerobot

        return write_lerobot(self.store, folder, rate=rate, action=action, task=task, robot_type=robot_type)

    def to_robomimic(
        self,
        path: str | Path,
        rate: float = 50.0,
        *,
        action: str = "tau",
        name: str = "robotraj",
        held_out: float = 0.1,
        scale: ArrayLike | None = None,
    ) -> Path:
        """Write the proved motions as robomimic's HDF5 file, one group ``demo_0``, ``demo_1`` ... a case.

        The observation ``state`` has q and v. Rewards and dones are 1 at the last sample. ``mask/train`` and
        ``mask/valid`` divide the episodes at random, always alike.

        Parameters
        ----------
        path : path
        rate : float
            Samples a second [Hz].
        action : str
            ``"tau"`` [N m, N], or ``"q"`` for the positions of the next sample.
        name : str
            Name of the environment.
        held_out : float
            Share of the episodes in ``mask/valid``.
        scale : float or array (nu,), optional
            Actions are divided by it: robomimic trains on actions from -1 to 1. ``robot.limits.effort`` suits torques.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            h5py is not installed, an option has another value, or no case has a motion.
        """
        from robotraj.applications.studies.data_sets.robomimic import write_robomimic

        return write_robomimic(self.store, path, rate=rate, action=action, name=name, held_out=held_out, scale=scale)

    def regressions(self, before: Study, **ratios: float) -> Regressions:
        """Return what became worse since an earlier study; see ``robotraj.applications.studies.regression``."""
        from robotraj.applications.studies.regression import regressions

        return regressions(before.figures, self.figures, **ratios)

    def __len__(self) -> int:
        return int(self.store.figures().num_rows)

    def __str__(self) -> str:
        table = self.figures
        if not table.num_rows or "status" not in table.column_names:
            return f"study of {self.store.cases().num_rows} cases: none is planned yet"
        counts: dict[str, int] = {}
        for status in table.column("status").to_pylist():
            counts[status] = counts.get(status, 0) + 1
        seconds = np.array([s for s in table.column("seconds").to_pylist() if s is not None and s == s])
        spent = f"{np.sum(seconds):.4g} s of processor time, {np.max(seconds, initial=0.0):.3g} s the slowest"
        proved = sum(bool(each) for each in table.column("proved").to_pylist())
        rest = f"{len(self.missing)} missing"
        first: dict[str, str] = {}
        failed = self.failures.select(["status", "message"]).to_pylist() if proved < table.num_rows else []
        for row in failed:
            first.setdefault(row["status"], f", the first one: {row['message']}")
        return f"study of {table.num_rows} plans, {proved} proved, {rest}; {spent}\n" + "\n".join(
            f"  {status}: {count}{first.get(status, '')}"
            for status, count in sorted(counts.items(), key=lambda each: -each[1])
        )


def _not(column: Any) -> Any:
    import pyarrow.compute as compute

    return compute.invert(column)
