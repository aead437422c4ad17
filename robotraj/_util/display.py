"""HTML of values in notebooks, by functions of higher rooms.

A solution is drawn by the replay page, which imports solutions. ``robotraj/__init__.py`` registers here which function
draws which class. The function is imported when it is first called.
"""

from __future__ import annotations

from importlib import import_module

drawings: dict[str, str] = {}
"""``module:function`` by the name of the class that it draws."""


def drawn(value: object) -> str:
    """Return the HTML of a value, by the function registered for its class.

    Raises
    ------
    KeyError
        No function is registered for the class.
    """
    module, _, function = drawings[type(value).__name__].partition(":")
    return str(getattr(import_module(module), function)(value))
