"""The sizes of the states of a whole plan, to which all errors of the witness are relative."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj.robot.size.state_sizes import state_sizes
from robotraj.witness.plants.of_phase import plant_of
from robotraj.witness.plants.plant import Plant
from robotraj.witness.protocols import SolutionLike

PLACES = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
"""Places of every interval at which the motion is sampled for its range."""


def sizes_of(solution: SolutionLike) -> list[Array]:
    """Return the sizes of the differences of states for every phase, (k,) each, in the unit of each.

    Phases with the same states share their sizes: a short phase may hardly move.
    """
    plants = [plant_of(planned) for planned in solution.phases]
    values = [
        _coordinates(plant, np.asarray(planned.knots, dtype=float))
        for plant, planned in zip(plants, solution.phases, strict=True)
    ]
    return [_shared(plant, plants, values) for plant in plants]


def named_sizes(solution: SolutionLike) -> list[dict[str, float]]:
    """Return the sizes of the states of every phase, by their names."""
    found = []
    for planned, sizes in zip(solution.phases, sizes_of(solution), strict=True):
        plant = plant_of(planned)
        found.append(dict(zip(plant.names, plant.spread(sizes).tolist(), strict=True)))
    return found


def _shared(plant: Plant, plants: Sequence[Plant], values: Sequence[Array]) -> Array:
    alike = [own for other, own in zip(plants, values, strict=True) if other.gap_names == plant.gap_names]
    return state_sizes(plant.gap_units, np.vstack(alike))


def _coordinates(plant: Plant, knots: Array) -> Array:
    """Sample the coordinates of a phase, (m, k)."""
    times = np.unique((knots[:-1, None] + np.diff(knots)[:, None] * PLACES).ravel())
    return plant.coordinates(plant.states(times))
