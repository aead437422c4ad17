"""``rt.plan`` warns of a long shooting plan before it builds it."""

from __future__ import annotations

import time
import warnings

import pytest

import robotraj as rt
from robotraj.planning.diagnosis.long_shooting import shooting_seconds


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
