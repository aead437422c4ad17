"""Commands of ``robotraj`` in this process, with their output."""

from __future__ import annotations

from typing import Any

from typer.testing import CliRunner, Result

from robotraj.cli.app import app


def run(*arguments: Any) -> Result:
    """Run a command in a terminal of 200 columns."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments], env={"COLUMNS": "200"})


def succeed(*arguments: Any) -> str:
    """Run a command that must succeed; return what it prints."""
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return result.stdout


def fail(*arguments: Any, code: int = 2) -> str:
    """Run a command that must fail with one line on the standard error, and return the line."""
    result = run(*arguments)
    assert result.exit_code == code and isinstance(result.exception, SystemExit)
    assert "Traceback" not in result.output
    (line,) = result.stderr.strip().splitlines()
    assert line.startswith("error: ")
    return line


def completions(words: str) -> list[str]:
    """Return the completions that bash offers for the last one of the words."""
    environment = {"_ROBOTRAJ_COMPLETE": "complete_bash", "COMP_WORDS": f"robotraj {words}"}
    environment["COMP_CWORD"] = str(len(words.split()))
    return CliRunner().invoke(app, [], prog_name="robotraj", env=environment).stdout.split()
