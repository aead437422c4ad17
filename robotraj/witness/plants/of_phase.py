"""The plant of a planned phase."""

from __future__ import annotations

from robotraj.witness.plants.plant import Plant
from robotraj.witness.plants.robot_plant import RobotPlant
from robotraj.witness.plants.system_plant import SystemPlant
from robotraj.witness.protocols import PhaseSolutionLike


def plant_of(planned: PhaseSolutionLike) -> Plant:
    """Return the plant of a phase: a robot by Pinocchio, or a System by its own equations."""
    return RobotPlant(planned) if planned.phase.robot is not None else SystemPlant(planned)
