"""Instructions that the inner pieces execute, by callgrind: ``python benchmarks/inner/instructions.py``.

Processor time on a shared machine is noisy by tens of percent; the number of instructions is not. One process runs all
pieces under ``valgrind --tool=callgrind`` (Debian package valgrind). Every piece is made and called once, so that
nothing is left to be cached, and then called again a few times between two marks: callgrind writes its counter down,
and starts again from zero, whenever the process calls getsid. The count of an empty interval is subtracted.
The table goes to ``instructions.md``; its last column is the difference between two runs.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TABLE = HERE / "instructions.md"
CALLS = 3
"""Calls of a piece in each of its two stretches."""


def child(names: list[str]) -> None:
    """Run the pieces of those names between marks, in order."""
    from pieces import PIECES

    chosen = [piece for piece in PIECES if piece.name in names]
    for piece in chosen:
        call = piece.make()
        call()
        for _ in range(2):
            os.getsid(0)
            for _ in range(CALLS):
                call()
        os.getsid(0)
    os.getsid(0)
    # The end of the interpreter is not counted.
    os._exit(0)


def count(names: list[str]) -> list[list[float]]:
    """Instructions of one call of every piece, in its two stretches."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "callgrind.out"
        subprocess.run(
            [
                "valgrind",
                "--tool=callgrind",
                "--dump-before=getsid",
                f"--callgrind-out-file={out}",
                sys.executable,
                str(Path(__file__).resolve()),
                "--child",
                *names,
            ],
            check=True,
            capture_output=True,
            env=os.environ | {"PYTHONHASHSEED": "0", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
        # The dump number k + 1 holds what came before mark k.
        totals: list[int] = []
        while (dump := Path(f"{out}.{len(totals) + 1}")).is_file():
            totals.append(_total(dump))
    marks = 3 * len(names) + 1
    if len(totals) < marks:
        raise SystemExit(f"callgrind wrote {len(totals)} dumps for {marks} marks; is getsid hidden from it?")
    empty = totals[marks - 1]
    return [[(totals[3 * i + part] - empty) / CALLS for part in (1, 2)] for i in range(len(names))]


def _total(dump: Path) -> int:
    found = re.search(r"^(?:summary|totals): (\d+)", dump.read_text(errors="replace"), re.MULTILINE)
    if found is None:
        raise SystemExit(f"{dump} holds no total.")
    return int(found[1])


def table(rows: list[tuple[str, str, list[float]]]) -> str:
    """Write the rows as Markdown."""
    lines = [
        "# Instructions of the inner pieces",
        "",
        "Of one call, counted by callgrind; `python benchmarks/inner/instructions.py` writes this table.",
        "",
        "| | piece | million instructions | two runs apart |",
        "|---|---|---:|---:|",
    ]
    for group, name, (first, second) in rows:
        apart = abs(first - second) / max(first, second, 1.0)
        lines.append(f"| {group} | {name} | {min(first, second) / 1e6:.2f} | {100 * apart:.2f} % |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--only", default="", help="pieces whose group or name contains this")
    parser.add_argument("--child", nargs="*", help=argparse.SUPPRESS)
    parser.add_argument("--out", type=Path, default=TABLE, help="where the table goes")
    given = parser.parse_args()
    if given.child is not None:
        child(given.child)
    if shutil.which("valgrind") is None:
        raise SystemExit("valgrind is not installed: apt-get install valgrind")
    from pieces import PIECES

    chosen = [piece for piece in PIECES if given.only in f"{piece.group} {piece.name}"]
    counts = count([piece.name for piece in chosen])
    text = table([(piece.group, piece.name, both) for piece, both in zip(chosen, counts, strict=True)])
    given.out.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
