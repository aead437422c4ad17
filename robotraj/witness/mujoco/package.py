"""MuJoCo itself, which is an extra: loaded where it is wanted, never before."""

from __future__ import annotations

from typing import Any

from robotraj._util.errors import InputError


def load_mujoco() -> Any:
    """Import MuJoCo.

    Raises
    ------
    InputError
        It is not installed; the message says how to get it.
    """
    try:
        import mujoco
    except ImportError as error:
        raise InputError(
            "The second opinion simulates with MuJoCo, which is not installed: pip install 'robotraj[mujoco]' "
            "(one wheel, 10 MB)."
        ) from error
    return mujoco
