"""What notebooks show of values that only a room above theirs can draw.

A solution is drawn by the replay page, which reads solutions and so lies above them. ``robotraj/__init__.py`` lies
above all rooms: it enters here which function draws which class. The function is imported when it is first called.
"""

from __future__ import annotations

from importlib import import_module

drawings: dict[str, str] = {}
"""``module:function`` by the name of the class that it draws."""


def drawn(value: object) -> str:
    """Return the HTML of a value: what ``function(value)`` of the entry of its class returns.

    Raises
    ------
    KeyError
        No function is entered for the class.
    """
    module, _, function = drawings[type(value).__name__].partition(":")
    return str(getattr(import_module(module), function)(value))
