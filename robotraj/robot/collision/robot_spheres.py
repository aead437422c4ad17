"""A robot's collision geometry as spheres: those of its URDF, and those that enclose its other shapes."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from robotraj._util.arrays import Array, Indices
from robotraj._util.lazy_values import cached_property
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.robot.collision.enclosing_spheres import EXCESS, union_volume
from robotraj.robot.collision.fit_cache import fitted
from robotraj.robot.collision.link_pairs import always_touching, candidate_pairs, too_coarse
from robotraj.robot.collision.placements import placements
from robotraj.robot.collision.tessellation import HALF_SPACES, triangles_of
from robotraj.robot.robot import Robot


class ShapeFit(NamedTuple):
    """How spheres enclose one shape.

    Attributes
    ----------
    name, link : str
    spheres : int
    protrusion : float
        Largest distance of the spheres beyond the shape [m]; 0 for a sphere.
    excess : float
        Volume of the spheres over that of the shape's convex hull, less 1.
    """

    name: str
    link: str
    spheres: int
    protrusion: float
    excess: float


@dataclass(frozen=True, eq=False)
class RobotSpheres(OneLine):
    """Spheres on the links of a robot, as plain arrays.

    Attributes
    ----------
    links : tuple of str
        Links that carry spheres.
    link : ndarray of int (n,)
        Index in ``links`` of each sphere's link.
    joint : ndarray of int (n,)
        Pinocchio's joint that carries each sphere; 0 for the world.
    centre : ndarray (n, 3)
        In the joint's frame [m].
    radius : ndarray (n,)
        [m].
    link_pairs : ndarray of int (m, 2)
        Pairs of links that are checked against each other.
    fits : tuple of ShapeFit
    """

    links: tuple[str, ...]
    link: Indices
    joint: Indices
    centre: Array
    radius: Array
    link_pairs: Indices
    fits: tuple[ShapeFit, ...]

    @cached_property
    def sphere_pairs(self) -> Indices:
        """Pairs of spheres on links that are checked against each other, (k, 2)."""
        of_link = [np.flatnonzero(self.link == i) for i in range(len(self.links))]
        parts = [
            np.stack(np.meshgrid(of_link[a], of_link[b], indexing="ij"), axis=-1).reshape(-1, 2)
            for a, b in self.link_pairs
        ]
        return np.concatenate([np.zeros((0, 2), dtype=int), *parts])

    def centres(self, robot: Robot, q: Array) -> Array:
        """Return the centres in the world (m, n, 3) [m] at configurations q (m, nq)."""
        rotations, origins = placements(robot, q)
        turned = np.einsum("mnij,nj->mni", rotations[:, self.joint], self.centre)
        return np.asarray(origins[:, self.joint] + turned)

    def self_distances(self, robot: Robot, q: Array) -> Array:
        """Return the distance [m] of each pair of links (configurations, pairs), negative where spheres overlap."""
        centres = np.moveaxis(self.centres(robot, q), 2, 0)
        found = np.zeros((len(q), len(self.link_pairs)))
        members = [self.link == i for i in range(len(self.links))]
        places = [np.ascontiguousarray(centres[:, :, own]) for own in members]
        for number, (a, b) in enumerate(self.link_pairs):
            # One pair of links after the other: all pairs of their spheres at once would not fit into the cache.
            squares = sum((x[:, :, None] - y[:, None]) ** 2 for x, y in zip(places[a], places[b], strict=True))
            apart = np.sqrt(squares)
            apart -= self.radius[members[a], None] + self.radius[members[b]]
            found[:, number] = apart.min(axis=(1, 2))
        return found


_KNOWN: WeakKeyDictionary[Robot, dict[frozenset[frozenset[str]], RobotSpheres]] = WeakKeyDictionary()


def robot_spheres(robot: Robot, disabled: Collection[tuple[str, str]] = ()) -> RobotSpheres:
    """Return the spheres of a robot; they are computed once per robot.

    Spheres of the URDF are used unchanged. Capsules, boxes, cylinders and meshes are enclosed by spheres, which are
    cached on disk (``fit_cache``). The floor of an MJCF file has none: it is compared exactly, as links are
    (``own_body``).

    Parameters
    ----------
    robot : Robot
    disabled : collection of (str, str)
        Pairs of links that are not checked against each other, as of ``read_srdf``. The pairs that ``link_pairs``
        describes are not checked either.

    Raises
    ------
    InputError
        A shape is of an unsupported kind.
    """
    known = _KNOWN.setdefault(robot, {})
    key = frozenset(frozenset(pair) for pair in disabled)
    if key not in known:
        known[key] = _made(robot, disabled)
    return known[key]


def _made(robot: Robot, disabled: Collection[tuple[str, str]]) -> RobotSpheres:
    links: list[str] = []
    link, joint, fits = [], [], []
    centres, radii = [np.zeros((0, 3))], [np.zeros(0)]
    for shape in robot.collision_model.geometryObjects:
        if type(shape.geometry).__name__ in HALF_SPACES:
            continue
        name = robot.model.frames[shape.parentFrame].name
        own, sizes, protrusion, excess = spheres_of(shape)
        if name not in links:
            links.append(name)
        fits.append(ShapeFit(shape.name, name, len(sizes), protrusion, excess))
        link += [links.index(name)] * len(sizes)
        joint += [int(shape.parentJoint)] * len(sizes)
        centres.append(own @ shape.placement.rotation.T + shape.placement.translation)
        radii.append(sizes)
    pairs = candidate_pairs(robot, links, disabled)
    numbers = np.array([(links.index(a), links.index(b)) for a, b in pairs], dtype=int).reshape(-1, 2)
    every = RobotSpheres(
        tuple(links),
        np.array(link, dtype=int),
        np.array(joint, dtype=int),
        np.concatenate(centres),
        np.concatenate(radii),
        numbers,
        tuple(fits),
    )
    kept = ~always_touching(robot, every)
    if any(fit.protrusion > 0.0 for fit in fits):
        kept &= ~too_coarse(robot, links, numbers, every)
    return replace(every, link_pairs=numbers[kept])


def spheres_of(shape: pin.GeometryObject) -> tuple[Array, Array, float, float]:
    """Return centres and radii in the shape's axes, the protrusion [m] and the excess volume of one shape."""
    geometry, name = shape.geometry, shape.name
    kind = type(geometry).__name__
    if kind == "Sphere":
        return np.zeros((1, 3)), np.array([float(geometry.radius)]), 0.0, 0.0
    if kind == "Capsule":
        return capsule_spheres(float(geometry.radius), float(geometry.halfLength))
    fit = fitted(triangles_of(geometry, name))
    excess = fit.volume / fit.hull_volume - 1.0 if fit.hull_volume > 0.0 else float("inf")
    return fit.centres, fit.radii, fit.protrusion, excess


def capsule_spheres(radius: float, half: float) -> tuple[Array, Array, float, float]:
    """Return spheres along the z axis whose union encloses a capsule, as ``spheres_of`` does."""
    reach = radius + min(EXCESS, 0.25 * radius)
    step = 2.0 * np.sqrt(reach**2 - radius**2)
    count = int(np.ceil(2.0 * half / step)) + 1
    places = np.linspace(-half, half, count) if count > 1 else np.zeros(1)
    gap = places[1] - places[0] if count > 1 else 0.0
    radii = np.full(count, np.hypot(radius, 0.5 * gap))
    centres = np.column_stack([np.zeros((count, 2)), places])
    volume = np.pi * radius**2 * (2.0 * half + 4.0 / 3.0 * radius)
    return centres, radii, float(radii[0] - radius), union_volume(centres, radii) / volume - 1.0
