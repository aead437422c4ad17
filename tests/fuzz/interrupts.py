"""Ctrl-C at random instants of plans, sweeps, multistarts, validations, replays and saves.

Each attempt repeats one action until the press ends it. It is right if the action ends as ``KeyboardInterrupt`` within
a second of processor time. The error holds whatever was finished, and every file is whole.

Python drops a press in the callback of a weakref. Calls of robotraj heed it, other code does not, such as the one that
frees a plan after the call: a second press follows.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable
from functools import partial, wraps
from pathlib import Path

import numpy as np

import robotraj as rt
from robotraj._util.system import interrupts as presses
from robotraj.applications.many import one_of_many
from robotraj.solution.errors import PlanInterrupted
from robotraj.solvers.status import Status

LONGEST = 1.0
"""Processor time between the press and the end [s]."""
AGAIN = 10.0
"""Time after which the user presses again [s]."""
COUNT = 12
"""Problems of a sweep, and starts."""
HEEDED = ("plan", "plan by IPOPT", "validate", "replay")
SOLVERS: dict[str, rt.InteriorPoint | rt.Ipopt | None] = {"": None, " by IPOPT": rt.Ipopt()}
LATEST = {f"{many}{by}": 1.5 for many in ("sweep", "multistart") for by in SOLVERS}
"""Latest instant of the press in wall-clock time [s]; 0.7 for the other actions."""


class Interrupts:
    """The actions, with what they need; a context manager.

    Parameters
    ----------
    folder : Path
        An empty folder for files.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._planned = folder, 0
        self._saved = rt.plan(_reach("two_link_arm", 0.5), rt.Mesh(20), check=False, progress=False)
        self._report = rt.validate(self._saved)
        self.actions: dict[str, Callable[[], object]] = {
            "plan": lambda: rt.plan(_reach("ur5", 0.5), progress=False),
            "plan by IPOPT": lambda: rt.plan(_reach("ur5", 0.5), rt.Mesh(40), solver=rt.Ipopt(), progress=False),
            **{f"sweep{by}": partial(self._sweep, solver) for by, solver in SOLVERS.items()},
            **{f"multistart{by}": partial(self._multistart, solver) for by, solver in SOLVERS.items()},
            "validate": lambda: rt.validate(self._saved),
            "replay": lambda: rt.replay(self._saved, folder / "page.html", report=self._report),
            "save": self._save,
        }

    def __enter__(self) -> Interrupts:
        plan = self._plan = one_of_many.plan

        @wraps(plan)
        def counted(*arguments: object, **options: object) -> rt.Solution:
            found = plan(*arguments, **options)
            self._planned += found.status is not Status.INTERRUPTED
            return found

        one_of_many.plan = counted
        return self

    def __exit__(self, *_: object) -> None:
        one_of_many.plan = self._plan

    def attempt(self, kind: str, delay: float) -> str:
        """Press Ctrl-C after a delay [s] of an action; return the fault, empty where there is none."""
        pressed: list[float] = []
        ended = threading.Event()

        def press() -> None:
            wait = delay
            while not ended.wait(wait):
                pressed.append(time.process_time())
                os.kill(os.getpid(), signal.SIGINT)
                wait = AGAIN

        dropped: list[bool] = []

        def drop(ignored: sys.UnraisableHookArgs) -> None:
            dropped.append(presses._before.get() is None)

        before, sys.unraisablehook = sys.unraisablehook, drop
        user = threading.Thread(target=press)
        user.start()
        error: BaseException | None = None
        try:
            while True:
                self._planned = 0
                self.actions[kind]()
        except BaseException as caught:
            ended.set()
            error = caught
        seconds = time.process_time() - pressed[-1] if pressed else 0.0
        user.join()
        sys.unraisablehook = before
        if not isinstance(error, KeyboardInterrupt):
            return f"{type(error).__name__}: {error}"
        if len(pressed) > 1 and kind in HEEDED and not any(dropped):
            return "it took a second press"
        if seconds > LONGEST:
            return f"it took {seconds:.2f} s of processor time"
        if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            return "another handler of Ctrl-C was left"
        return self._lost(error) or self._broken()

    def _lost(self, error: KeyboardInterrupt) -> str:
        if (
            isinstance(error, PlanInterrupted)
            and not np.isfinite(error.solution.at(error.solution.duration / 2).q).all()
        ):
            return "the solution of the error is not finite"
        if isinstance(error, rt.applications.Interrupted):
            numbers = sorted([*error.found, *error.running, *error.left])
            if numbers != list(range(error.count)):
                return f"found, running and left hold {numbers}"
            if len(error.found) < self._planned:
                return f"{self._planned} plans were finished and {len(error.found)} are left"
        return ""

    def _broken(self) -> str:
        """Check that files are whole, old or new, and that nothing else is there."""
        for path in self._folder.iterdir():
            if path.suffix == ".npz":
                rt.load_solution(path)
            elif path.suffix == ".json":
                json.loads(path.read_text(encoding="utf-8"))
            elif path.suffix == ".html":
                if not path.read_text(encoding="utf-8").rstrip().endswith("</html>"):
                    return f"{path.name} is cut"
            elif path.suffix == ".csv":
                if len(path.read_text(encoding="utf-8").splitlines()) != 202:
                    return f"{path.name} is cut"
            else:
                return f"{path.name} is left"
        return ""

    def _sweep(self, solver: rt.InteriorPoint | rt.Ipopt | None) -> object:
        reaches = [_reach("two_link_arm", 0.3 + 0.02 * i) for i in range(COUNT)]
        return rt.sweep(reaches, mesh=rt.Mesh(15), solver=solver)

    def _multistart(self, solver: rt.InteriorPoint | rt.Ipopt | None) -> object:
        return rt.multistart(_reach("two_link_arm", 0.5), COUNT, mesh=rt.Mesh(15), solver=solver)

    def _save(self) -> None:
        self._saved.save(self._folder / "plan.npz")
        self._saved.to_csv(self._folder / "plan.csv")
        self._saved.to_json(self._folder / "plan.json")


def faults(folder: Path, count: int, seed: int) -> list[str]:
    """Press Ctrl-C ``count`` times, kind by kind, and return what was wrong."""
    rng, found = np.random.default_rng([49, seed]), []
    with warnings.catch_warnings(), Interrupts(folder) as interrupts:
        warnings.simplefilter("ignore")
        kinds = list(interrupts.actions)
        for number in range(count):
            kind = kinds[number % len(kinds)]
            delay = float(rng.uniform(0.005, LATEST.get(kind, 0.7)))
            if fault := interrupts.attempt(kind, delay):
                found.append(f"{kind} after {delay:.3f} s: {fault}")
    return found


def _reach(name: str, far: float) -> rt.Phase:
    robot = rt.load(name)
    first = np.array([-1.1, -1.8, 1.6, -1.2, -1.57, 0.0]) if name == "ur5" else np.zeros(robot.nq)
    return rt.Phase(robot, 5.0, rt.State(q=first, v=0), rt.State(q=first + far, v=0), rt.Effort())
