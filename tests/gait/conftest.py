"""The robots of several tests."""

from __future__ import annotations

import pytest

import robotraj as rt

MOTORS = {"position": (-2.5, 2.5), "velocity": 20.0, "effort": 2.7}
"""Limits of the motors of Solo12 and Bolt; their URDFs have placeholders."""


@pytest.fixture(scope="session")
def solo() -> rt.Robot:
    return rt.load("solo12", root="floating", limits=MOTORS)


@pytest.fixture(scope="session")
def bolt() -> rt.Robot:
    return rt.load("bolt", root="floating", limits=MOTORS)


@pytest.fixture(scope="session")
def biped() -> rt.Robot:
    return rt.load("five_link", root="planar")


@pytest.fixture(scope="session")
def dog() -> rt.Robot:
    """Solo12 with its joints' whole range."""
    return rt.load("solo12", root="floating", limits={"velocity": 30.0, "effort": 3.0})
