"""Spheres of robots: those of the URDF, those that enclose shapes, and which pairs of links are checked."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.robot.collision import placements, read_srdf, robot_spheres
from robotraj.robot.collision.enclosing_spheres import enclose, encloses, union_volume
from robotraj.robot.collision.fit_cache import fitted, folder
from robotraj.robot.collision.robot_spheres import spheres_of
from robotraj.robot.collision.tessellation import triangles_of


def link(name: str, shape: str = "", at: str = "0 0 0") -> str:
    body = f'<collision><origin xyz="{at}"/><geometry>{shape}</geometry></collision>' if shape else ""
    inertia = '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="{name}"><inertial><mass value="1"/>{inertia}</inertial>{body}</link>'


def joint(name: str, parent: str, child: str, axis: str = "0 1 0") -> str:
    limit = '<limit lower="-2" upper="2" velocity="2" effort="50"/>'
    links = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.5"/>'
    return f'<joint name="{name}" type="revolute">{links}<axis xyz="{axis}"/>{limit}</joint>'


def arm(tmp_path: Path) -> rt.Robot:
    """Three links: a sphere, cylinders and a box; first and last touch in no configuration, middle ones always."""
    text = "".join(
        [
            link("base", '<sphere radius="0.1"/>'),
            link("upper", '<cylinder radius="0.05" length="0.3"/>', "0 0 0.25"),
            link("lower", '<box size="0.1 0.1 0.4"/>', "0 0 0.25"),
            link("hand", '<cylinder radius="0.05" length="0.1"/>', "0 0 -0.1"),
            joint("shoulder", "base", "upper"),
            joint("elbow", "upper", "lower"),
            joint("wrist", "lower", "hand", "0 0 1"),
        ]
    )
    path = tmp_path / "arm.urdf"
    path.write_text(f'<robot name="arm">{text}</robot>')
    return rt.load(path)


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def test_placements_are_those_of_pinocchio() -> None:
    for robot in (rt.load("ur5"), rt.load("cartpole"), rt.load("solo12", root="floating")):
        q = np.array(
            [pin.integrate(robot.model, robot.neutral, v) for v in np.random.default_rng(0).normal(size=(5, robot.nv))]
        )
        rotations, origins = placements(robot, q)
        data = robot.model.createData()
        for k in range(5):
            pin.forwardKinematics(robot.model, data, q[k])
            for j in range(robot.model.njoints):
                np.testing.assert_allclose(rotations[k, j], data.oMi[j].rotation, atol=1e-12)
                np.testing.assert_allclose(origins[k, j], data.oMi[j].translation, atol=1e-12)


def test_spheres_enclose_every_shape(tmp_path: Path) -> None:
    robot = arm(tmp_path)
    spheres = robot_spheres(robot)
    assert spheres.links == ("base", "upper", "lower", "hand")
    assert [fit.spheres for fit in spheres.fits][0] == 1 and spheres.fits[0].protrusion == 0.0
    rng = np.random.default_rng(0)
    for shape in robot.collision_model.geometryObjects:
        triangles = None if type(shape.geometry).__name__ in ("Sphere", "Capsule") else triangles_of(shape.geometry, "")
        if triangles is None:
            continue
        weights = rng.dirichlet(np.ones(3), size=500)
        points = np.einsum("ni,nij->nj", weights, triangles[rng.integers(len(triangles), size=500)])
        placed = points @ shape.placement.rotation.T + shape.placement.translation
        own = spheres.joint == shape.parentJoint
        apart = np.linalg.norm(placed[:, None] - spheres.centre[own], axis=2) - spheres.radius[own]
        assert apart.min(axis=1).max() < 1e-9


def test_a_capsule_is_enclosed_by_spheres_on_its_axis() -> None:
    shape = pin.GeometryObject("capsule", 0, pin.SE3.Identity(), coal.Capsule(0.05, 0.3))
    centres, radii, protrusion, _ = spheres_of(shape)
    rim = np.column_stack([np.full(200, 0.05), np.zeros(200), np.linspace(-0.15, 0.15, 200)])
    apart = np.linalg.norm(rim[:, None] - centres, axis=2) - radii
    assert apart.min(axis=1).max() <= 1e-12 and protrusion <= 0.01


def test_links_that_joints_join_and_that_always_touch_are_not_checked(tmp_path: Path) -> None:
    spheres = robot_spheres(arm(tmp_path))
    pairs = {(spheres.links[a], spheres.links[b]) for a, b in spheres.link_pairs}
    # The hand's cylinder reaches into the lower link, its neighbour; upper and hand are apart by the elbow's range.
    assert pairs == {("base", "lower"), ("base", "hand"), ("upper", "hand")}


def test_an_srdf_disables_pairs(tmp_path: Path) -> None:
    path = tmp_path / "arm.srdf"
    path.write_text('<robot name="arm"><disable_collisions link1="lower" link2="base" reason="Never"/></robot>')
    disabled = read_srdf(path)
    assert disabled == (("lower", "base"),)
    spheres = robot_spheres(arm(tmp_path), disabled)
    pairs = {(spheres.links[a], spheres.links[b]) for a, b in spheres.link_pairs}
    assert pairs == {("base", "hand"), ("upper", "hand")}


def test_a_missing_srdf_is_called_one(tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match=r"There is no SRDF file '.*none\.srdf'"):
        read_srdf(tmp_path / "none.srdf")


def test_distances_between_links_are_those_of_their_spheres(tmp_path: Path) -> None:
    robot = arm(tmp_path)
    spheres, q = robot_spheres(robot), np.random.default_rng(0).uniform(-2, 2, size=(4, 3))
    centres = spheres.centres(robot, q)
    for k, found in enumerate(spheres.self_distances(robot, q)):
        for (a, b), distance in zip(spheres.link_pairs, found, strict=True):
            apart = [
                np.linalg.norm(centres[k, i] - centres[k, j]) - spheres.radius[i] - spheres.radius[j]
                for i in np.flatnonzero(spheres.link == a)
                for j in np.flatnonzero(spheres.link == b)
            ]
            assert distance == pytest.approx(min(apart))


def test_fits_are_kept_by_content_and_a_damaged_file_is_not_used() -> None:
    triangles = triangles_of(rt.load("ur5").collision_model.geometryObjects[-1].geometry, "box")
    first = fitted(triangles)
    (path,) = folder().glob("*.npz")
    again = fitted(triangles)
    np.testing.assert_array_equal(again.centres, first.centres)
    np.savez(path, **(first._asdict() | {"radii": 0.1 * first.radii}))
    np.testing.assert_array_equal(fitted(triangles).radii, first.radii)
    whole = path.read_bytes()
    for damaged in (b"no archive", b"", whole[:-40], whole[:60] + b"damaged" + whole[67:], b"\x93NUMPY"):
        path.write_bytes(damaged)
        np.testing.assert_array_equal(fitted(triangles).radii, first.radii)
    many = np.zeros((10_000, 3)), np.full(10_000, 10.0)
    np.savez(path, **(first._asdict() | dict(zip(("centres", "radii"), many, strict=True))))
    np.testing.assert_array_equal(fitted(triangles).radii, first.radii)


def test_enclosure_fails_for_smaller_spheres_and_volumes_are_those_of_spheres() -> None:
    mesh = triangles_of(rt.load("ur5").collision_model.geometryObjects[-2].geometry, "wrist")
    fit = enclose(mesh)
    assert encloses(fit.centres, fit.radii, mesh) and not encloses(fit.centres, 0.9 * fit.radii, mesh)
    assert union_volume(np.zeros((2, 3)), np.ones(2)) == pytest.approx(4 / 3 * np.pi)
