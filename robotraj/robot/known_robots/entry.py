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
        The name for ``rt.load``, and a description of one line.
    source : str
        Source: ``"robots/"`` or ``"example-robot-data"``.
    urdf : Path
        Its URDF file.
    srdf : Path or None
        Its SRDF file, with reference configurations and rotors.
    actuated : tuple of str or None
        Joints with a motor; None for all.
    moving : tuple of str
        Prefixes of the names of moving joints; the others are locked at the reference. Empty: all
        joints move.
    end_effector : str or None
        Frame whose path replays draw.
    licence, provenance : str
        Terms of distribution and source of the numbers, as far as known.
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
