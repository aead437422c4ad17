"""``load_obstacles``: read the shapes of a scene from a TOML file."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import cast

from robotraj._util.errors import unknown_name
from robotraj.applications.problem_files.lines import Misplaced
from robotraj.applications.problem_files.parameters import parameters_of
from robotraj.applications.problem_files.reader import Reader
from robotraj.applications.problem_files.toml_file import read_toml
from robotraj.dynamics.obstacles.base import Obstacle
from robotraj.problem.constraints.collision_free import CollisionFree

TABLE = "obstacles"


def load_obstacles(path: str | os.PathLike[str]) -> tuple[Obstacle, ...]:
    """Read the tables ``[[obstacles]]`` of a file, each with the type and the fields of a class of ``rt.obstacles``.

    Raises
    ------
    InputError
        There is no such file, it is no TOML, or it has no obstacles; the message names line and key.
    """
    file = read_toml(path, "The file of obstacles")
    with file.placed():
        for key in file.data:
            if key != TABLE:
                raise Misplaced((key,), str(unknown_name("table", key, [TABLE])))
        if not file.data.get(TABLE):
            raise Misplaced((), 'has no obstacles: add [[obstacles]] with type = "Box", sides and position [m].')
        accepted = parameters_of(CollisionFree)[TABLE].accepted
        given = Reader(file.source.parent, {}, {}).value(file.data[TABLE], accepted, (TABLE,))
    return tuple(cast("Sequence[Obstacle]", given))
