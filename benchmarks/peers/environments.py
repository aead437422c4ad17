"""One virtual environment for each peer, made once in a cache folder by pip alone.

python benchmarks/peers/environments.py [--cache FOLDER] [NAME ...]    # makes them all, or those named
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Environment:
    """What pip installs.

    Attributes
    ----------
    packages : tuple of str
    alone : tuple of str
        Installed after these, without their dependencies.
    """

    packages: tuple[str, ...]
    alone: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """One line, from which a change is seen."""
        return " ".join((*self.packages, "|", *self.alone))


# cyipopt has no wheels; cyipopt-wheels is the same module with IPOPT in it.
IPOPT = "cyipopt-wheels==1.7.0.dev0"
ENVIRONMENTS: dict[str, Environment] = {
    "drake": Environment(("drake==1.51.1",)),
    # Crocoddyl 3.2.1 was built against Pinocchio 4.0.0; pip's own choice of a later one gives wrong numbers silently.
    "crocoddyl": Environment(("crocoddyl==3.2.1", "pin==4.0.0", "example-robot-data-loaders==5.0.0")),
    "dymos": Environment(("dymos==1.15.1", "openmdao==3.45.1", "pin==4.1.0", IPOPT)),
    # opty requires cyipopt by that name.
    "opty": Environment(("cython", "numpy", "scipy", "setuptools", "sympy", IPOPT), alone=("opty==1.5.0",)),
}
MINUTES = 15
DEFAULT_CACHE = Path.home() / ".cache" / "robotraj-peers"


def python_of(name: str | None, cache: Path) -> Path:
    """Return an environment's interpreter, installed first where it is missing; None is the running one.

    Raises
    ------
    RuntimeError
        The peer could not be installed within ``MINUTES``.
    """
    if name is None:
        return Path(sys.executable)
    folder, wanted = cache / name, ENVIRONMENTS[name]
    python, done = folder / "bin" / "python", folder / "installed"
    if not done.exists() or done.read_text() != wanted.text:
        venv.create(folder, with_pip=True, clear=True)
        install = [str(python), "-m", "pip", "install", "--quiet"]
        try:
            subprocess.run([*install, *wanted.packages], check=True, timeout=60 * MINUTES)
            if wanted.alone:
                subprocess.run([*install, "--no-deps", *wanted.alone], check=True, timeout=60 * MINUTES)
        except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
            raise RuntimeError(f"not installed: {error}") from error
        done.write_text(wanted.text)
    return python


def main() -> None:
    """Make the environments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help=f"of {', '.join(ENVIRONMENTS)}; all by default")
    parser.add_argument("--cache", type=Path, default=DEFAULT_CACHE)
    options = parser.parse_args()
    for name in options.names or ENVIRONMENTS:
        print(name, python_of(name, options.cache.resolve()), flush=True)


if __name__ == "__main__":
    main()
