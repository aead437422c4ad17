"""One entry of the catalogue of robots."""

from __future__ import annotations

from pathlib import Path

from robotraj._util.values import dataclass


@dataclass(frozen=True)
class KnownRobot:
    """A robot that ``rt.load`` can load by name.

    Attributes
    ----------
    name, description : str
        The name to load it by, and one line on what it is.
    source : str
        Where it comes from: ``"robots/"`` or ``"example-robot-data"``.
    urdf : Path
        Its URDF file.
    srdf : Path or None
        Its SRDF file, with reference configurations and rotors.
    actuated : tuple of str or None
        Joints with a motor; None for all.
    moving : tuple of str
        Beginnings of the names of the joints that move; the others are locked at the reference. Empty: all
        move.
    end_effector : str or None
        The frame whose path is worth drawing.
    licence, provenance : str
        Under which terms it ships and where its numbers come from, as far as known.
    """

    name: str
    description: str
    source: str
    urdf: Path
    srdf: Path | None = None
    actuated: tuple[str, ...] | None = None
    moving: tuple[str, ...] = ()
    end_effector: str | None = None
    licence: str = ""
    provenance: str = ""
