"""Compiled modules: check their versions against the installed libraries, and explain why one could not be loaded."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import casadi
import pinocchio

from robotraj._util.errors import BuildMismatch

_WHEELS = {"pinocchio": "pin"}  # libraries whose wheel has another name


def check_versions(graphs: ModuleType) -> None:
    """Compare what the compiled module was built against with what is installed.

    The file name of libpinocchio carries no version. A module built against another version loads all the same, and
    then reads its memory wrongly. The versions must therefore be equal, not just compatible.

    Parameters
    ----------
    graphs : module
        The compiled module, or anything with its ``PINOCCHIO_VERSION`` and ``CASADI_VERSION``.

    Raises
    ------
    BuildMismatch
        When pinocchio, libpinocchio or casadi is of another version.
    """
    installed = {"pinocchio": pinocchio.__version__, "casadi": casadi.CasadiMeta.version()}
    built = {"pinocchio": graphs.PINOCCHIO_VERSION, "casadi": graphs.CASADI_VERSION}
    library = wheel_version("libpinocchio")
    if library is not None:  # otherwise pinocchio was not installed from wheels, and its own version decides
        installed["libpinocchio"], built["libpinocchio"] = library, graphs.PINOCCHIO_VERSION
    for name, version in installed.items():
        if version != built[name]:
            raise BuildMismatch(
                f"robotraj's compiled module was built against {name} {built[name]}, but {name} {version} is "
                f"installed. Go back with 'pip install {_WHEELS.get(name, name)}=={built[name]}', or install a "
                "robotraj for that version in an environment of its own."
            )


def wheel_version(name: str) -> str | None:
    """Return the version of an installed wheel, None where there is none.

    The first ``<name>-<version>.dist-info`` on Python's path holds it, as it does for ``importlib.metadata``, whose
    import takes longer than loading the module.
    """
    found = (path for entry in sys.path for path in Path(entry).glob(f"{name}-*.dist-info"))
    first = next(found, None)
    return None if first is None else first.name.removesuffix(".dist-info").rpartition("-")[2]


def not_loaded(module: str, error: Exception) -> BuildMismatch:
    """Build the error for a compiled module that could not be imported.

    Parameters
    ----------
    module : str
        Its full name.
    error : Exception
        What the import raised.

    Returns
    -------
    BuildMismatch

    Notes
    -----
    A folder of sources shadows an installed robotraj when Python runs inside it. Another ``pip install .`` would not
    help there, since it puts the compiled modules into the installed package.
    """
    folder = Path(__file__).resolve().parents[3]
    from_sources = (folder / "pyproject.toml").exists()
    if from_sources and find_spec(module) is None:
        return BuildMismatch(
            f"Python imports robotraj from its sources in {folder}, where {module} is not compiled. "
            "Run Python in another folder, or run 'pip install -e .' in this one."
        )
    known = wheel_version("robotraj")
    wheel = "robotraj" if known is None else f"robotraj=={known}"
    remedy = (
        f"Build it again: 'pip install -e .' in {folder}."
        if from_sources
        else f"Install its wheel again, which brings the libraries it was built for: 'pip install --force-reinstall "
        f"{wheel}'. Where no wheel fits this machine, pip builds one, which needs a C++ compiler."
    )
    return BuildMismatch(
        f"robotraj's compiled module {module} could not be loaded beside pinocchio {pinocchio.__version__} and "
        f"casadi {casadi.CasadiMeta.version()} ({error}). {remedy}"
    )
