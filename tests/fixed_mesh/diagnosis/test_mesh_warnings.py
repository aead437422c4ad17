"""``rt.plan`` warns of a mesh by which a plan takes long, or hides power between its points, before it builds it."""

from __future__ import annotations

import time
import warnings

import pytest

import robotraj as rt
from robotraj.fixed_mesh.diagnosis.mesh_warnings import shooting_seconds


def reach(name: str) -> rt.Phase:
    robot = rt.load(name)
    return rt.Phase(robot, 1.0, rt.State(q=robot.neutral, v=0), rt.State(q=robot.neutral, v=0), rt.Effort())


def test_a_warning_of_long_shooting_names_what_takes_less_time() -> None:
    began = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning, match=r"Shooting .* s of processor time.*collocation.*rt\.Mesh"):
            rt.plan(reach("ur5"), mesh=rt.Mesh(30, rt.schemes.SingleShooting()))
    assert time.process_time() - began < 5.0


def test_short_shooting_and_collocation_are_not_warned_of() -> None:
    arm, swing = rt.Problem([reach("ur5")]), rt.Problem([reach("pendulum")])
    assert shooting_seconds(arm, rt.Mesh(30)) == 0.0
    assert shooting_seconds(swing, rt.Mesh(20, rt.schemes.SingleShooting())) < 20.0
    assert 10.0 < shooting_seconds(arm, rt.Mesh(20, rt.schemes.MultipleShooting())) < 60.0


def test_compressed_collocation_of_an_arm_is_short() -> None:
    """Compressed collocation starts from its separated form: 60 intervals of a panda take 3 s."""
    arm = rt.Problem([reach("panda")])
    assert shooting_seconds(arm, rt.Mesh(100, rt.schemes.CompressedHermiteSimpson())) == 0.0


def test_the_estimate_grows_with_the_square_of_the_pieces_of_single_shooting() -> None:
    arm = rt.Problem([reach("ur5")])
    few, many = (shooting_seconds(arm, rt.Mesh(count, rt.schemes.SingleShooting())) for count in (10, 20))
    assert many == pytest.approx(4.0 * few)


def works(objective: rt.objectives.MechanicalWork, mesh: rt.Mesh) -> list[str]:
    """Return the warnings of power that is hidden, for a lift of a pendulum on this mesh."""
    ends = rt.State(q=0.0, v=0.0), rt.State(q=0.5, v=0.0)
    lift = rt.Phase(rt.load("pendulum"), 1.0, *ends, objective, limits=None)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rt.plan(lift, mesh=mesh, check=False)
    return [str(each.message) for each in caught if "power" in str(each.message)]


def test_free_torques_inside_intervals_may_hide_power() -> None:
    work, smooth = rt.objectives.MechanicalWork(), rt.objectives.MechanicalWork(smoothing=0.1)
    lines = rt.HermiteSimpson(control=rt.schemes.LinearControl())
    (warned,) = works(work, rt.Mesh(6))
    assert "LinearControl" in warned
    assert works(rt.objectives.AbsolutePower(), rt.Mesh(6, rt.schemes.RadauIIA(3)))
    assert not works(work, rt.Mesh(6, lines))
    assert not works(work, rt.Mesh(6, rt.schemes.Trapezoidal()))
    assert not works(smooth, rt.Mesh(6))
