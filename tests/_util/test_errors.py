"""An error in a user's function is reported with the function's name and with the original error as its cause."""

from __future__ import annotations

import pickle
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import casadi as ca
import pytest

import robotraj as rt
from robotraj._util.errors import FailedExpression, UnknownName, called, unknown_name, warn


def test_what_a_function_returns_is_handed_on() -> None:
    assert called("sum", lambda a, b: a + b, 1, 2) == 3


def test_an_error_of_ones_own_becomes_the_cause_of_one_that_names_the_function() -> None:
    own = RuntimeError("first line\nsecond  line")

    def fails(point: object) -> None:
        raise own

    with pytest.raises(FailedExpression) as caught:
        called("expression of constraint 'power'", fails, 0)
    assert caught.value.__cause__ is own
    message = str(caught.value)
    assert message.startswith("The expression of constraint 'power' failed: RuntimeError: first line second line. ")
    assert str(pickle.loads(pickle.dumps(caught.value))) == message


def test_an_expression_of_other_arguments_is_shown_how_it_is_written() -> None:
    cart = rt.load("cartpole")

    def message(objective: rt.objectives.Objective) -> str:
        with pytest.raises(FailedExpression) as caught:
            rt.Phase(cart, 1.0, rt.State(q=0, v=0), rt.State(q=0, v=0), objective)
        return str(caught.value)

    assert "called with 1 argument: write lambda point: ..." in message(rt.Lagrange(lambda q, v: q[0] ** 2))
    assert "called with 2 arguments: write lambda start, end: ..." in message(rt.Mayer(lambda end: end.q[0]))
    assert "called with 1 argument and reads" in message(rt.objectives.Tracking(lambda: {"q": [0, 0]}))


def test_errors_of_robotraj_pass_through() -> None:
    def fails() -> None:
        raise unknown_name("state", "w", ["x", "v"])

    with pytest.raises(UnknownName, match=r"^There is no state named 'w'"):
        called("expression", fails)


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (lambda x: x[9], "RuntimeError: Slice (start=9, stop=10, step=1) out of bounds with supplied length of 2. It"),
        (lambda x: x["a"], "NotImplementedError: Wrong number or type of arguments for overloaded function 'SX_get'."),
        (lambda x: abs(x[0]) and 1, "RuntimeError: Cannot compute the truth value of a CasADi SXElem symbolic"),
        (lambda x: x[0] or 1, "casadi.logic_or"),
        (lambda: 0, "It is called with 1 argument and"),
    ],
    ids=["index", "name", "and", "or", "arguments"],
)
def test_errors_of_casadi_lose_their_source_lines_and_prototypes(function: object, expected: str) -> None:
    with pytest.raises(FailedExpression) as caught:
        called("expression", function, ca.SX.sym("x", 2))  # type: ignore[arg-type]
    message = str(caught.value)
    assert expected in message and ".cpp" not in message and "prototypes" not in message and "\n" not in message


def test_what_a_point_has_is_listed_where_something_else_is_asked_of_it() -> None:
    phase = rt.Phase(rt.load("two_link_arm"), 1.0, rt.State(v=0), rt.State(v=0), rt.Effort())
    ball = rt.PathConstraint(lambda point: point.frame("tip").translation, 0, 1, name="ball")
    with pytest.raises(FailedExpression, match=r"'translation'\. It has acceleration, position, rotation, velocity\.$"):
        rt.plan(phase.with_(constraints=[ball]))
    bad = rt.Lagrange(lambda point: point.torque)
    with pytest.raises(FailedExpression, match=r"'torque'\. It has .*\btau\b"):
        rt.plan(phase.with_(objective=bad))


def test_a_warning_of_a_plan_points_at_the_line_of_the_call() -> None:
    block = rt.load("block")
    moves = [rt.Phase(block, 4.0, rt.State(q=0, v=0), rt.State(q=1, v=0), rt.Effort(), name=name) for name in "ab"]
    apart = rt.Problem(moves, [])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rt.plan(apart, rt.Mesh(4), check=False)
    unlinked = [each for each in caught if "not linked" in str(each.message)]
    assert unlinked and all(each.filename == __file__ for each in unlinked)


def test_a_warning_skips_the_frames_of_context_managers() -> None:
    @contextmanager
    def context() -> Iterator[None]:
        yield

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with context():
            warn("first")
        context()(warn)("second")
    assert [each.filename for each in caught] == [__file__, __file__]


@pytest.mark.parametrize(
    ("call", "advice"),
    [(rt.validate, r"rt\.load_solution\('a\.npz'\)"), (rt.plan, r"rt\.load_problem\('a\.npz'\)\.plan\(\)")],
)
def test_a_path_in_place_of_a_value_names_the_call_that_reads_it(call: Callable[..., object], advice: str) -> None:
    for path in ("a.npz", Path("a.npz")):
        with pytest.raises(rt.InputError, match=advice):
            call(path)


def test_names_that_differ_in_capitals_or_by_one_word_are_near() -> None:
    frames = ["root_joint", "base_link", "FL_HAA", "FL_FOOT", "FR_FOOT"]
    assert "Did you mean 'FL_FOOT'" in str(unknown_name("frame", "FL_foot_link", frames))
    assert "Did you mean 'FR_FOOT'" in str(unknown_name("frame", "fr_foot", frames))


def test_messages_cannot_control_a_terminal() -> None:
    """Names of files, joints and phases stand in messages."""
    assert str(rt.InputError("the joint '\x1b[31m\x07\u202e'\nis none")) == "the joint '\\x1b[31m\\x07\\u202e'\nis none"
    with pytest.warns(UserWarning, match=r"^\\x9bm$"):
        warn("\x9bm")
