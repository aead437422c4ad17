import warnings

import coal
import numpy as np
import pinocchio as pin
import pytest

from robotraj.replay_page.scene.visuals import DEFAULT_COLOR, visuals_of


def test_talos_keeps_its_mirrored_meshes_mirrored(talos):
    visuals = visuals_of(talos.model, talos.visual_model)
    things = talos.visual_model.geometryObjects
    assert len(visuals) == len(things)
    signs = [np.sign(np.linalg.det(v.placement[:3, :3])) for v in visuals]
    assert signs == [np.sign(np.prod(thing.meshScale)) for thing in things]
    assert signs.count(-1.0) == 13


@pytest.mark.parametrize("name", ["ur5", "talos", "double_pendulum"])
def test_every_visual_fills_the_box_of_pinocchios_mesh(name, request):
    robot = request.getfixturevalue(name)
    visuals = {v.name: v for v in visuals_of(robot.model, robot.visual_model)}
    for thing in robot.visual_model.geometryObjects:
        if not hasattr(thing.geometry, "vertices"):
            continue
        visual = visuals[thing.name]
        assert visual.joint == thing.parentJoint
        vertices = np.concatenate([p.vertices for p, _ in visual.parts])
        drawn = vertices @ visual.placement[:3, :3].T + visual.placement[:3, 3]
        placement = thing.placement.homogeneous  # coal's vertices have the scale in them
        known = np.asarray(thing.geometry.vertices()) @ placement[:3, :3].T + placement[:3, 3]
        np.testing.assert_allclose(drawn.min(axis=0), known.min(axis=0), atol=3e-5)
        np.testing.assert_allclose(drawn.max(axis=0), known.max(axis=0), atol=3e-5)


def test_the_urdf_colour_comes_before_the_files_own(ur5, talos):
    for visual, thing in zip(visuals_of(ur5.model, ur5.visual_model), ur5.visual_model.geometryObjects, strict=True):
        assert not thing.overrideMaterial
        assert [c for _, c in visual.parts] == [p.color for p, _ in visual.parts]
    for visual, thing in zip(
        visuals_of(talos.model, talos.visual_model), talos.visual_model.geometryObjects, strict=True
    ):
        if thing.overrideMaterial:
            np.testing.assert_allclose([c for _, c in visual.parts], [thing.meshColor.ravel()] * len(visual.parts))


def one_body(shape, color=None) -> tuple[pin.Model, pin.GeometryModel]:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    geometry = pin.GeometryModel()
    thing = pin.GeometryObject("thing", joint, pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])), shape)
    if color is not None:
        thing.meshColor, thing.overrideMaterial = np.array(color), True
    geometry.addGeometryObject(thing)
    return model, geometry


def test_a_primitive_wears_its_colour_at_its_place():
    (visual,) = visuals_of(*one_body(coal.Box(0.2, 0.4, 0.6), [1.0, 0.5, 0.0, 0.7]))
    assert visual.parts[0][1] == (1.0, 0.5, 0.0, 0.7)
    corners = visual.corners()
    np.testing.assert_allclose(corners.min(axis=0), [0.0, 0.0, 0.0], atol=1e-5)
    np.testing.assert_allclose(corners.max(axis=0), [0.2, 0.4, 0.6], atol=1e-5)


def test_geometry_without_any_colour_is_light_grey(double_pendulum):
    model, geometry = one_body(coal.Sphere(0.1))
    geometry.geometryObjects[0].meshColor = np.array([0.9, 0.9, 0.9, 1.0])
    ((visual),) = visuals_of(model, geometry)
    assert visual.parts[0][1] == DEFAULT_COLOR


def test_what_cannot_be_drawn_is_named_and_the_rest_is_shown():
    model, geometry = one_body(coal.TriangleP(np.zeros(3), np.eye(3)[0], np.eye(3)[1]))
    ball = pin.GeometryObject("ball", 1, pin.SE3.Identity(), coal.Sphere(0.1))
    geometry.addGeometryObject(ball)
    with pytest.warns(UserWarning, match="'thing'.*TriangleP"):
        visuals = visuals_of(model, geometry)
    assert [v.name for v in visuals] == ["ball"]


def test_a_broken_mesh_file_falls_back_on_the_loaded_mesh(tmp_path):
    import trimesh

    mesh = trimesh.creation.box(extents=[0.2, 0.4, 0.6])
    held = coal.BVHModelOBBRSS()
    held.beginModel(len(mesh.faces), len(mesh.vertices))
    held.addVertices(mesh.vertices)
    held.addTriangles(mesh.faces)
    held.endModel()
    model, geometry = one_body(held)
    (tmp_path / "broken.dae").write_text("<COLLADA")
    geometry.geometryObjects[0].meshPath = str(tmp_path / "broken.dae")
    with pytest.warns(UserWarning, match="broken.dae"):
        (visual,) = visuals_of(model, geometry)
    np.testing.assert_allclose(np.ptp(visual.corners(), axis=0), [0.2, 0.4, 0.6], atol=1e-5)


@pytest.mark.parametrize("geometry", [None, pin.GeometryModel()])
def test_a_model_without_visuals_is_drawn_as_rods_between_its_joints(ur5, geometry):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        visuals = visuals_of(ur5.model, geometry)
    joints = {v.joint for v in visuals}
    assert set(range(1, ur5.model.njoints)) <= joints
    for child in range(2, ur5.model.njoints):
        (parent,) = [v for v in visuals if v.joint == ur5.model.parents[child]]
        end = ur5.model.jointPlacements[child].translation
        corners = parent.corners()
        assert np.all(corners.min(axis=0) <= end + 1e-4)
        assert np.all(corners.max(axis=0) >= end - 1e-4)
