"""The witness, the replay and files use the robot with its optimised design."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.replay_page.write import replay
from robotraj.solution.storage.packing import Packer
from robotraj.solution.storage.unpacking import Unpacker
from robotraj.witness.simulation.tracking import track

DESIGN = {
    "m": rt.design.BodyMass("forearm"),
    "L": rt.design.LinkLength("shoulder", along=(1, 0, 0)),
    "w": rt.design.Payload("tip"),
    "d": rt.design.JointDamping("elbow"),
}


@pytest.fixture(scope="module")
def solution(arm) -> rt.Solution:
    reach = rt.Phase(
        arm,
        duration=1.5,
        start=rt.State(q=[0, 0.3], v=0),
        end=rt.State(q=[0.5, -0.4], v=0),
        objective=rt.Effort(),
        constraints=[rt.PathConstraint(lambda p: p.frame("tip").velocity[1], lower=-2, upper=2, name="speed")],
        limits=None,
        parameters={"m": rt.between(1, 3), "L": rt.between(0.7, 2), "w": 0.8, "d": 0.3},
        design=DESIGN,
    )
    return rt.plan(reach, mesh=rt.Mesh(20))


def test_the_simulation_follows_the_plan(solution) -> None:
    report = rt.validate(solution)
    assert report.passed
    assert abs(report.energy.relative) < 1e-4
    assert track(solution, 10.0, 1.0).error.largest("q.") < 1e-3


def test_the_simulation_needs_the_design(solution, arm, monkeypatch) -> None:
    """Under the same torques, the arm of the URDF moves differently."""
    monkeypatch.setitem(solution.phases[0].phase.__dict__, "bound_design", None)
    assert not rt.validate(solution).passed


def test_the_solution_gives_the_robot(solution, arm) -> None:
    planned = solution.phases[0]
    robot, values = planned.robot, planned.parameters
    assert robot.model.inertias[2].mass == pytest.approx(values["m"] + 0.8, rel=1e-12)
    np.testing.assert_allclose(robot.model.jointPlacements[2].translation, [values["L"], 0, 0.1], atol=1e-12)
    assert robot.damping.tolist() == [0, 0.3]


def test_the_replay_places_joints_by_the_design(solution, tmp_path, monkeypatch) -> None:
    from robotraj.replay_page.scene import scene

    seen = []
    motion_of = scene.motion_of
    monkeypatch.setattr(scene, "motion_of", lambda *given: seen.append(motion_of(*given)) or seen[-1])
    assert replay(solution, tmp_path / "arm.html").exists()
    np.testing.assert_allclose(seen[0].position[:, 2, 0], solution.phases[0].parameters["L"], rtol=0, atol=1e-12)


def test_the_replay_refuses_two_lengths(arm, tmp_path) -> None:
    def half(name: str, start: float, length: float, load: float) -> rt.Phase:
        return rt.Phase(
            arm,
            duration=1.0,
            start=rt.State(q=start, v=0),
            end=rt.State(q=start + 0.2, v=0),
            limits=None,
            parameters={"L": length, "w": load},
            design={"L": rt.design.LinkLength("elbow"), "w": rt.design.Payload("tip")},
            name=name,
        )

    one, loaded, long = half("reach", 0.0, 1.0, 0.0), half("carry", 0.2, 1.0, 0.7), half("long", 0.2, 1.1, 0.0)
    links = [rt.Continuity(0, 1)]
    assert replay(rt.plan(rt.Problem([one, loaded], links), mesh=rt.Mesh(3)), tmp_path / "load.html").exists()
    with pytest.raises(rt.InputError, match="'long' moves"):
        replay(rt.plan(rt.Problem([one, long], links), mesh=rt.Mesh(3)), tmp_path / "length.html")


def test_quantities_are_plain_data() -> None:
    packer = Packer()
    written = packer.pack(DESIGN, "design")
    assert Unpacker(packer.arrays).unpack(written) == DESIGN


def test_files_keep_the_design(solution, tmp_path) -> None:
    with pytest.warns(UserWarning, match="speed"):
        loaded = rt.load_solution(solution.save(tmp_path / "arm.npz"))
    assert loaded.phases[0].phase.design == DESIGN
    assert loaded.phases[0].robot.model == solution.phases[0].robot.model
