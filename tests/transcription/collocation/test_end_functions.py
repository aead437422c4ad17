"""Functions at the ends of phases are made once for all meshes, and given up with their phases."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

import robotraj as rt
from robotraj.native.engines.base import VirtualMachine
from robotraj.transcription.collocation.end_functions import _FUNCTIONS
from tests.programs import nlp_of


def hop() -> rt.Problem:
    """Two phases with a Mayer term, a constraint at an end and a link."""
    block = rt.load("block")
    ends = rt.constraints.AtEnd(rt.PathConstraint(lambda point: point.q[0] ** 2, upper=4.0, name="square"))
    first = rt.Phase(block, 1.0, rt.State(q=0, v=0), rt.State(), rt.Effort(), constraints=[ends], limits=None)
    cost = rt.Effort() + rt.Mayer(lambda start, end: (end.v[0] - start.v[0]) ** 2)
    second = rt.Phase(block, (0.5, 2.0), rt.State(), rt.State(q=3, v=0), cost, limits=None)
    return rt.Problem([first, second], links=[rt.Continuity(0, 1)])


def stages_at_ends(nlp: rt.transcription.nlp.Nlp) -> list[object]:
    return [block.stage for block in nlp.blocks if block.count == 1]


def test_a_finer_mesh_has_the_functions_of_the_first() -> None:
    problem = hop()
    coarse, fine = (nlp_of(problem, rt.Mesh(count, rt.HermiteSimpson())) for count in (3, 7))
    assert len(stages_at_ends(coarse)) >= 3
    assert all(a is b for a, b in zip(stages_at_ends(coarse), stages_at_ends(fine), strict=True))


def test_functions_on_a_finer_mesh_are_those_of_a_new_problem() -> None:
    problem = hop()
    nlp_of(problem, rt.Mesh(3))
    again, fresh = nlp_of(problem, rt.Mesh(7)), nlp_of(hop(), rt.Mesh(7))
    w = np.random.default_rng(0).normal(size=len(again.variables))
    np.testing.assert_array_equal(again.values(w), fresh.values(w))
    assert again.objective(w) == fresh.objective(w)


def test_another_set_of_free_scalars_has_functions_of_its_own() -> None:
    problem = hop()
    fixed = rt.Problem([problem.phases[0], problem.phases[1].with_(duration=1.0)], links=problem.links)
    for each in (problem, fixed, problem):
        nlp, fresh = nlp_of(each, rt.Mesh(4)), nlp_of(each, rt.Mesh(4), engine=VirtualMachine())
        assert len(nlp.rows) == len(fresh.rows)
        assert rt.plan(each, rt.Mesh(4), progress=False).success


def test_functions_end_with_their_problem() -> None:
    problem = hop()
    nlp_of(problem, rt.Mesh(3))
    owners = [weakref.ref(each) for each in (*problem.phases, *problem.bound_links) if each in _FUNCTIONS]
    assert len(owners) >= 3
    del problem
    gc.collect()
    assert not any(owner() is not None for owner in owners)


def test_a_scheme_without_a_point_at_the_end_is_refused_after_one_that_has_it() -> None:
    ends = rt.constraints.AtStart(rt.PathConstraint(lambda point: point.tau[0], upper=1.0, name="push"))
    phase = rt.Phase(rt.load("block"), 1.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort(), constraints=[ends])
    problem = rt.Problem([phase])
    nlp_of(problem, rt.Mesh(3, rt.HermiteSimpson()))
    with pytest.raises(rt.InputError, match="no collocation point there"):
        nlp_of(problem, rt.Mesh(3, rt.schemes.GaussLegendre(3)))
