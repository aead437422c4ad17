"""``robotraj profile``: where the seconds of a saved solution went."""

from __future__ import annotations

from robotraj.cli.options import FileArgument
from robotraj.cli.terminal import say


def profile(file: FileArgument) -> None:
    """Show where the seconds of a saved solution went: build, compile, and the parts of the solve."""
    from robotraj.solution.storage.load import load_solution

    solution = load_solution(file)
    total = solution.seconds
    for name, seconds in sorted(solution.times.items()):
        label = f"  {name.partition(': ')[2]}" if ":" in name else name
        say(f"{label:<32}{seconds:10.4f} s {seconds / total if total else 0:8.1%}")
    say(f"{'total':<32}{total:10.4f} s of processor time, {solution.iterations} iterations")
