"""Import of MuJoCo, an optional dependency."""

from __future__ import annotations

from types import ModuleType

from robotraj._util.errors import InputError


def load_mujoco() -> ModuleType:
    """Import MuJoCo.

    Raises
    ------
    InputError
        MuJoCo is not installed.
    """
    try:
        import mujoco
    except ImportError as error:
        raise InputError(
            "MuJoCo is not installed, and rt.witness.second_opinion simulates with it: pip install 'robotraj[mujoco]'."
        ) from error
    return mujoco
