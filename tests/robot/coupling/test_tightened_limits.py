"""Limits of a leader lie within those of its followers, whatever the sign of the multiplier."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt

LIMIT = '<limit lower="{}" upper="{}" velocity="{}" effort="4"/>'


def load(urdf, follow, low=-1.0, high=0.5, speed=3.0, **options):
    follower = LIMIT.format(low, high, speed) + f'<mimic joint="lead" {follow}/>'
    lead = LIMIT.format(-2, 2, 3)
    return rt.load(urdf.chain(("lead", "revolute", "0 0 1", lead), ("b", "revolute", "0 0 1", follower)), **options)


@pytest.mark.parametrize(
    ("follow", "low", "high", "speed"),
    [
        ('multiplier="1"', -1.0, 0.5, 3.0),
        ('multiplier="-1"', -0.5, 1.0, 3.0),
        ('multiplier="2" offset="0.1"', -0.55, 0.2, 1.5),
        ('multiplier="-2" offset="0.1"', -0.2, 0.55, 1.5),
    ],
)
def test_the_followers_limits_bound_the_leader(urdf, follow, low, high, speed):
    limits = load(urdf, follow).limits
    assert limits.joints == ("lead",)
    assert (limits.position_lower[0], limits.position_upper[0]) == pytest.approx((low, high))
    assert (limits.velocity_lower[0], limits.velocity_upper[0]) == pytest.approx((-speed, speed))
    assert limits.effort_upper[0] == 4.0


def test_zeros_of_a_follower_are_no_limits(urdf):
    limits = load(urdf, 'multiplier="1"', 0.0, 0.0, 0.0).limits
    assert (limits.position_lower[0], limits.velocity_upper[0]) == (-2.0, 3.0)


def test_the_callers_limits_come_last(urdf):
    limits = load(urdf, 'multiplier="1"', limits={"position": {"lead": (-2, 2)}}).limits
    np.testing.assert_array_equal(limits.position_upper, [2.0])
