"""Warnings that point at the user's line."""

from __future__ import annotations

import sys
import warnings

_OURS = __name__.partition(".")[0]
_PASSED_THROUGH = (_OURS, "contextlib")


def warn(message: str) -> None:
    """Issue a ``UserWarning`` at the innermost line outside of robotraj, however deep the caller stands in it.

    Examples
    --------
    >>> import pytest
    >>> with pytest.warns(UserWarning, match="too long"):
    ...     warn("The motion is too long.")
    """
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and _module(frame.f_globals) in _PASSED_THROUGH:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, stacklevel=level)


def _module(names: dict[str, object]) -> str:
    return str(names.get("__name__", "")).partition(".")[0]
