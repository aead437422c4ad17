"""The fields of a sample exist by the kind of its plan: joints of robots, named variables of Systems."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import robotraj as rt


def planned(subject: rt.Robot | rt.System, start: rt.State, end: rt.State, objective: object) -> rt.Solution:
    return rt.plan(rt.Phase(subject, 1.0, start, end, objective), mesh=rt.Mesh(4))


def test_a_robots_sample_has_joints_of_its_sizes() -> None:
    cart = rt.load("cartpole")
    sample = planned(cart, rt.State(q=0, v=0), rt.State(q=[0.1, 0], v=0), rt.Effort()).at(np.linspace(0, 1, 5))
    sizes = {"q": cart.nq, "v": cart.nv, "a": cart.nv, "tau": cart.nu}
    for name, size in sizes.items():
        assert getattr(sample, name).shape == (5, size)
    doubled = replace(sample, tau=2.0 * sample.tau)
    assert np.array_equal(doubled.tau, 2.0 * sample.tau) and doubled.q is sample.q


@pytest.mark.parametrize("name", ["q", "v", "a", "tau"])
def test_a_systems_sample_names_its_variables_in_place_of_joints(name: str) -> None:
    block = rt.System(states=["x", "speed"], controls=["u"], dynamics=lambda point: [point.x["speed"], point.u["u"]])
    cost = rt.Lagrange(lambda point: point.u["u"] ** 2)
    sample = planned(block, rt.State({"x": 0, "speed": 0}), rt.State({"x": 1, "speed": 0}), cost).at(0.5)
    with pytest.raises(rt.InputError, match=rf"has no '{name}'.*sample.x\['x', 'speed'\], sample.u\['u'\]"):
        getattr(sample, name)
    assert not hasattr(sample, name)
    assert sample.x["x"] == pytest.approx(0.5)
    for copied in (replace(sample, t=0.6), copy.copy(sample), pickle.loads(pickle.dumps(sample))):
        assert copied.x == sample.x and not hasattr(copied, name)
