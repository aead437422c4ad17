"""Output of a plan at the shell: its figures, its proof and its files."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import field
from pathlib import Path

import typer

from robotraj._util.system.whole_files import WholeFile
from robotraj._util.values import dataclass
from robotraj.cli.exits import ExitCode
from robotraj.cli.terminal import notes, say, say_json
from robotraj.replay_page.options import ReplayOptions
from robotraj.replay_page.write import replay
from robotraj.solution.claims.claim import as_data
from robotraj.solution.errors import NoSolutionFound, PlanInterrupted
from robotraj.solution.solution import Solution
from robotraj.witness.report import Report
from robotraj.witness.validation import ValidationOptions, validate


@dataclass(frozen=True)
class Files:
    """Paths of the files of a solution, None for files that are not written, and the options of ``rt.replay``."""

    html: Path | None = None
    save: Path | None = None
    plot: Path | None = None
    replay: ReplayOptions = field(default_factory=lambda: ReplayOptions())

    def write(self, solution: Solution, report: Report | None = None) -> list[Path]:
        """Write the files and list their absolute paths; the page shows the report."""
        written = []
        if self.save is not None:
            written.append(solution.save(self.save))
        if self.plot is not None:
            with WholeFile(self.plot) as file:
                _draw(solution, file, self.plot.suffix[1:])
            written.append(self.plot)
        if self.html is not None:
            written.append(replay(solution, self.html, report=report, **self.replay))
        return written


def _draw(solution: Solution, file: Path, kind: str) -> None:
    """Draw with Matplotlib's own settings: a ``matplotlibrc`` of the working folder could start LaTeX."""
    import matplotlib  # a third of a second to import

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        solution.plot().savefig(file, format=kind)


def conclude(
    solution: Solution, files: Files, *, as_json: bool = False, validation: ValidationOptions | None = None
) -> None:
    """Print a solution and its proof, write its files, and exit with 4 if the proof failed.

    ``validation`` holds options of ``rt.validate``.
    """
    report = validate(solution, **(validation or {}))
    if as_json:
        say_json(described(solution, report, files.write(solution, report)))
    else:
        say(f"{solution}\n")
        say(report)
        for path in files.write(solution, report):
            say(f"wrote {path}")
    if not report.passed:
        raise typer.Exit(ExitCode.NOT_PROVED)


def planned(make: Callable[[], Solution], files: Files, as_json: bool) -> Solution:
    """Plan; at Ctrl-C, or without a motion, write the files and describe the last iterate before the error goes on."""
    try:
        return make()
    except (NoSolutionFound, PlanInterrupted) as error:
        written = files.write(error.solution)
        if as_json:
            say_json(described(error.solution, None, written))
        else:
            for path in written:
                say(f"wrote {path}")
        raise


def described(solution: Solution, report: Report | None, written: list[Path]) -> dict[str, object]:
    """Describe a solution and its proof as plain data.

    Keys of the plan: ``status``, ``success``, ``message``, ``objective``, ``duration`` [s], ``parameters``. Keys of the
    solver: ``iterations``, ``seconds``, ``times`` [s of processor time], ``intervals`` of each phase by name. Keys of
    the proof: ``proved``, ``verdict``, ``error`` (relative, between knots), ``claims``, ``figures``, ``violations``
    and ``failures`` (text). ``warnings`` lists the notes of the command, ``written`` paths.
    Unknown values are null.
    """
    return {
        "status": solution.status.value,
        "success": solution.success,
        "proved": None if report is None else report.passed,
        "verdict": None if report is None else report.verdict,
        "message": solution.message,
        "objective": number(solution.objective),
        "duration": number(solution.duration),
        "iterations": int(solution.iterations),
        "seconds": number(solution.seconds),
        "times": {name: number(seconds) for name, seconds in solution.times.items()},
        "error": number(solution.error),
        "parameters": {name: number(value) for name, value in solution.parameters.items()},
        "violations": [str(violation) for violation in solution.violations(20)],
        "claims": as_data(solution.claims if report is None else report.claims),
        "figures": {} if report is None else _figures(report),
        "warnings": notes(),
        "failures": [] if report is None else list(report.failures(report.tolerances)),
        "intervals": {part.phase.name: len(part.knots) - 1 for part in solution.phases},
        "written": [str(path) for path in written],
    }


def _figures(report: Report) -> dict[str, object]:
    """Return the figures of a report.

    ``local``, ``tracking`` and ``drift`` are relative to the sizes of the states, ``violation`` to the range of the
    row, ``energy`` to the energy that moved. ``seconds`` is processor time.
    """
    loop = None if report.closed_loop is None else report.closed_loop.error
    drifts = {"local": report.local, "tracking": loop, "drift": report.drift}
    return {
        **{name: number(None if each is None else each.worst.relative) for name, each in drifts.items()},
        "violation": number(max((each.relative for each in report.breaches), default=0.0)),
        "energy": number(None if report.energy is None else report.energy.relative),
        "seconds": number(report.seconds),
    }


def number(value: float | None) -> float | None:
    """Return a finite number, else None, which JSON writes as null."""
    return float(value) if value is not None and math.isfinite(value) else None
