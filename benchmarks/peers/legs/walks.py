"""Crocoddyl's own walking examples as plain data, the same for both tools. SI units."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Walk:
    """One gait of ``crocoddyl.utils``, from standing still.

    Attributes
    ----------
    robot : str
    kind : str
        "walk" or "trot".
    feet : tuple of str
        Frames.
    length, height : float
        Of a step [m]; the first steps, on the right, are half as long.
    dt : float
        Of a shooting node [s].
    swing, support : int
        Nodes of a swing and of the stance on all feet before it.
    swings : tuple of (feet, share)
        Swinging feet in order, and the step as a fraction of ``length``; None is a stance on all feet.
    friction : float
    sole : (length, width), optional
        Of the robot's flat foot [m].
    box : (length, width), optional
        Its size in Crocoddyl's example [m].
    """

    title: str
    robot: str
    feet: tuple[str, ...]
    posture: str
    length: float
    height: float
    dt: float
    swing: int
    support: int
    swings: tuple[tuple[tuple[str, ...], float] | None, ...]
    friction: float = 0.7
    sole: tuple[float, float] | None = None
    box: tuple[float, float] | None = None

    def phases(self) -> list[tuple[tuple[str, ...], float, float]]:
        """(Feet that swing, how far [m], how long [s]) in the order of time."""
        whole: list[tuple[tuple[str, ...], float, float]] = []
        for entry in self.swings:
            feet, share = entry or ((), 0.0)
            nodes = self.swing if entry else self.support
            whole.append((feet, share * self.length, nodes * self.dt))
        return whole


FEET = ("FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT")
SOLES = ("left_sole_link", "right_sole_link")
WALKS = {
    # Nodes of Crocoddyl's examples/quadrupedal_gaits_fwddyn.py; steps are shorter and lower: solo12 is 0.235 m high.
    "L1": Walk(
        "solo12 walk", "solo12", FEET, "standing", 0.1, 0.05, 1e-2, 25, 2,
        (None, (("HR_FOOT",), 0.5), (("FR_FOOT",), 0.5), None, (("HL_FOOT",), 1.0), (("FL_FOOT",), 1.0)),
    ),
    "L2": Walk(
        "solo12 trot", "solo12", FEET, "standing", 0.1, 0.05, 1e-2, 25, 2,
        (None, (("FR_FOOT", "HL_FOOT"), 0.5), None, (("FL_FOOT", "HR_FOOT"), 1.0)),
    ),
    # examples/bipedal_gaits_fwddyn.py, first task.
    "L3": Walk(
        "talos_legs walk", "talos_legs", SOLES, "half_sitting", 0.6, 0.1, 3e-2, 15, 4,
        (None, (("right_sole_link",), 0.5), None, (("left_sole_link",), 1.0)), sole=(0.2, 0.12), box=(0.1, 0.05),
    ),
}  # fmt: skip
