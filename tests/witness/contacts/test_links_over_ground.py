"""The lowest places of links are those of coal's shapes, and a link below the ground is noticed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.witness.contacts.ground import swings_of
from robotraj.witness.contacts.links_over_ground import link_depths_of
from tests.robots.bag import bag_robot, crouch


@pytest.mark.slow
def test_heights_are_those_of_coal() -> None:
    """At every sampled time no vertex of a link is lower than its depth, and one is as low."""
    robot = rt.load("solo12", root="floating")
    found = rt.plan(rt.gait.trot(robot, step_length=0.08, duration=0.4))
    depths, _ = link_depths_of(found, swings_of(found, 9), 9)
    model, shapes = robot.model, robot.collision_model
    data, placed = model.createData(), shapes.createData()
    for each in depths:
        part = next(part for part in found.phases if part.phase.name == each.phase)
        q = part.at(np.array([each.time])).q[0]
        pin.updateGeometryPlacements(model, data, shapes, placed, q)
        lowest = np.inf
        for k, shape in enumerate(shapes.geometryObjects):
            if model.frames[shape.parentFrame].name == each.link:
                vertices = np.array(shape.geometry.vertices())
                lowest = min(lowest, (vertices @ placed.oMg[k].rotation.T + placed.oMg[k].translation)[:, 2].min())
        if np.isfinite(lowest):
            assert abs(-lowest - (each.depth + each.lowered)) < 1e-6
    assert max(each.depth for each in depths) < 1e-4
    assert min(each.lowered for each in depths) > 0.015, "solo12's contacts are the middles of balls of 16 mm"


def test_a_link_below_the_ground_is_noticed(tmp_path: Path) -> None:
    """A plan of a robot with a small box is a lie about one with a large box, and the claim names the box's link."""
    found = rt.plan(crouch(bag_robot(tmp_path, bag=0.05), 0.3))
    assert rt.validate(found).passed
    heavy = bag_robot(tmp_path, bag=0.9)
    lie = replace(found, phases=tuple(replace(part, phase=replace(part.phase, subject=heavy)) for part in found.phases))
    depths, _ = link_depths_of(lie, (), 9)
    worst = max(depths, key=lambda each: each.depth)
    _, height, pitch = lie.phases[0].at(np.array([worst.time])).q[0, :3]
    corner = min(-x * np.sin(pitch) + z * np.cos(pitch) for x in (-0.17, -0.07) for z in (-0.5, 0.4))
    assert worst.link == "body"
    assert abs(worst.depth + worst.lowered + height + corner) < 1e-9
    report = rt.validate(lie)
    assert not report.passed
    assert "Link 'body' is below the ground" in str(report)


@pytest.mark.slow
def test_a_shape_larger_than_its_link_is_left_out() -> None:
    """simple_humanoid's body has a capsule of three metres, which lies below its feet as it stands."""
    robot = rt.load("simple_humanoid", root="floating")
    found = rt.plan(rt.gait.walk(robot, step_length=0.1, duration=0.6), time_limit=60)
    report = rt.validate(found)
    assert any(each.startswith("BODY over the ground") for each in report.left_out)
    assert report.passed
