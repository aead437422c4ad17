"""Write README's table of eight times from RESULTS.md: robotraj beside the fastest other on four tasks.

python benchmarks/peers/front.py
"""

from __future__ import annotations

import re
from pathlib import Path

HERE = Path(__file__).resolve().parent
README, RESULTS = HERE.parents[1] / "README.md", HERE / "RESULTS.md"
TASKS = ("T2", "T3", "T4", "T5")
OURS, TIME, OVER = "robotraj", "build + solve [s]", "over a limit"
LEAST_EXCESS = 0.5
"""Excess over a limit between the knots [percent] from which a plan is marked."""


def tables(results: str) -> dict[str, list[dict[str, str]]]:
    """Rows of every task's table by its title, each row by the names of its columns; without failed runs."""
    found: dict[str, list[dict[str, str]]] = {}
    for title, body in re.findall(r"^### (T\d .*?)\n\n((?:\|.*\n)+)", results, re.MULTILINE):
        head, _, *lines = ([cell.strip() for cell in line.strip("|").split("|")] for line in body.splitlines())
        found[title] = [row for line in lines if (row := dict(zip(head, line, strict=False))).get("runs")]
    return found


def marked(row: dict[str, str]) -> str:
    """Seconds of a row, with a star where the plan exceeds a limit between the knots."""
    excess = float(row[OVER].split()[0])
    return row[TIME].split()[0] + ("*" if excess > LEAST_EXCESS else "")


def front(results: str) -> str:
    """Table of README."""
    lines = ["| task | robotraj [s] | fastest other [s] | which |", "|---|---|---|---|"]
    for title, rows in sorted(tables(results).items()):
        if title.split()[0] in TASKS and (title.split()[0] != "T4" or " 50 intervals" in title):
            ours = next(row for row in rows if row["tool"] == OURS)
            others = [row for row in rows if not row["tool"].startswith("robotraj")]
            best = min(others, key=lambda row: float(row[TIME].split()[0]))
            lines.append(f"| {title[3:]} | {marked(ours)} | {marked(best)} | {best['tool']} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Replace the text between README's markers."""
    before, rest = README.read_text().split("<!-- peers:begin -->")
    after = rest.split("<!-- peers:end -->")[1]
    README.write_text(f"{before}<!-- peers:begin -->\n{front(RESULTS.read_text())}<!-- peers:end -->{after}")


if __name__ == "__main__":
    main()
