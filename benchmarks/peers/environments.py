"""One virtual environment for each peer, made once in a cache folder."""

from __future__ import annotations

import subprocess
import sys
import venv
from pathlib import Path

ENVIRONMENTS: dict[str, tuple[str, ...]] = {
    "drake": ("drake",),
    # Crocoddyl 3.2.1 was built against Pinocchio 4.0.0; pip's own choice of a later one gives wrong numbers silently.
    "crocoddyl": ("crocoddyl==3.2.1", "pin==4.0.0", "example-robot-data-loaders==5.0.0"),
}
MINUTES = 5


def python_of(name: str | None, cache: Path) -> Path:
    """Give an environment's interpreter, installing it first where needed; None is the running one.

    Raises
    ------
    RuntimeError
        The peer could not be installed within ``MINUTES``.
    """
    if name is None:
        return Path(sys.executable)
    folder = cache / name
    python, done = folder / "bin" / "python", folder / "installed"
    wanted = "\n".join(ENVIRONMENTS[name])
    if not done.exists() or done.read_text() != wanted:
        venv.create(folder, with_pip=True, clear=True)
        command = [str(python), "-m", "pip", "install", "--quiet", *ENVIRONMENTS[name]]
        try:
            subprocess.run(command, check=True, timeout=60 * MINUTES)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            raise RuntimeError(f"not installed: {error}") from error
        done.write_text(wanted)
    return python
