"""Contacts are values: they can be compared, sent to other processes and saved."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.storage.packing import Packer
from robotraj.solution.storage.unpacking import Unpacker

VALUES = [
    rt.PointContact(
        "foot", friction=0.5, ground=rt.terrain.Slope(0.1), offset=np.array([0.0, 0.1, 0.0]), normal_force=[5, 90]
    ),
    rt.FlatFoot("foot", np.array([0.1, 0.2]), 0.1, sole=rt.contacts.FourCorners(), normal=[0, 0, 2], forward=[1, 0, 0]),
    rt.FlatFoot("foot", 0.2, 0.1, sole=rt.contacts.PressureAndTorsion(rt.contacts.Linearised(6), radius=0.02)),
    rt.contacts.ArcFoot("foot", 0.1, 0.2, normal=np.array([0.0, 0.0, 2.0])),
    rt.contacts.LineContact("foot", 0.1, direction=np.array([0.0, 3.0, 0.0])),
    rt.contacts.LoopClosure("left", "right", rigid=True),
]


@pytest.mark.parametrize("contact", VALUES, ids=lambda contact: type(contact).__name__)
def test_contacts_compare_pickle_and_are_stored_by_value(contact: Any) -> None:
    assert pickle.loads(pickle.dumps(contact)) == contact
    assert len({contact, pickle.loads(pickle.dumps(contact))}) == 1
    packer = Packer()
    packed = packer.pack(contact, "contact")
    assert Unpacker(packer.arrays).unpack(packed) == contact


def test_directions_are_kept_as_unit_vectors() -> None:
    assert VALUES[1].normal == (0.0, 0.0, 1.0) and VALUES[1].length == (0.1, 0.2)
    assert VALUES[3].normal == (0.0, 0.0, 1.0) and VALUES[4].direction == (0.0, 1.0, 0.0)


def test_a_bound_contact_travels_to_another_process(case: Any) -> None:
    bound = case.bind()
    copy = pickle.loads(pickle.dumps(bound))
    q, v, a = case.random(0)
    point = case.numbers(q, v, a)
    assert copy.forces == bound.forces
    assert copy.acceleration(point) == bound.acceleration(point)


def test_a_friction_in_percent_is_doubted():
    for contact in (rt.PointContact, lambda frame, friction: rt.FlatFoot(frame, 0.2, 0.1, friction=friction)):
        with pytest.warns(UserWarning, match="is 70, above that of any material.* 70 percent are 0.7"):
            contact("foot", friction=70)
