"""Calls with arguments that do not fit name the near ones; everything else about a public name is unchanged."""

import inspect
import pickle

import pytest

import robotraj as rt
from robotraj._util.names.keywords import WrongArguments, guarded

CART = rt.load("cartpole")
MOVE = rt.Phase(CART, 2.0, rt.State(q=[0, 0], v=0), rt.State(q=[1, 0], v=0), rt.Effort())

MISTAKES = {
    "rt.plan named 'tol'. Did you mean 'tolerance'": lambda: rt.plan(MOVE, tol=1e-6),
    "Phase named 'ends'. Did you mean 'end'": lambda: rt.Phase(CART, 2.0, ends=rt.State(v=0)),
    "Box named 'pos'. Did you mean 'position'": lambda: rt.obstacles.Box((1, 1, 1), pos=(0, 0, 0)),
    "Limits.with_ named 'efort'. Did you mean 'effort'": lambda: CART.limits.with_(efort=3.0),
    "rt.gait.walk named 'step_lenght'. Did you mean 'step_length'": lambda: rt.gait.walk(CART, step_lenght=0.1),
    "rt.validate named 'driftt'. Did you mean 'drift'": lambda: rt.validate(None, driftt=0.1),
    "Replanner named 'deadlines'. Did you mean 'deadline'": lambda: rt.Replanner(MOVE, deadlines=0.1),
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_wrong_keyword_of_a_public_call_names_near_ones(text: str) -> None:
    with pytest.raises(rt.InputError, match="There is no argument of " + text.replace(".", r"\.")) as caught:
        MISTAKES[text]()
    assert isinstance(caught.value, TypeError)


def test_methods_of_what_a_call_returns_name_near_keywords() -> None:
    solution = rt.plan(MOVE, mesh=rt.Mesh(10))
    for call in (solution.violations, solution.phases[0].at):
        with pytest.raises(WrongArguments, match="There is no argument of .* Valid names: "):
            call(number=3)


def test_missing_and_superfluous_arguments_print_the_call() -> None:
    with pytest.raises(WrongArguments, match=r"called as rt.between\(lower, upper\); .* too many positional arguments"):
        rt.between(1, 2, 3)
    with pytest.raises(WrongArguments, match="missing a required argument: 'duration'"):
        rt.Phase(CART)


def test_an_error_inside_a_call_that_fits_is_unchanged() -> None:
    def careless(count: int) -> int:
        return len(count)

    with pytest.raises(TypeError, match="has no len") as caught:
        guarded(careless)(3)
    assert not isinstance(caught.value, WrongArguments)


@pytest.mark.parametrize("name", ["plan", "between", "gait.walk", "planning.plan", "Phase", "constraints.between"])
def test_public_names_keep_their_signature_and_travel(name: str) -> None:
    public: object = rt
    for part in name.split("."):
        public = getattr(public, part)
    assert callable(public) and pickle.loads(pickle.dumps(public)) is public
    inner = inspect.unwrap(public)
    assert inspect.signature(public) == inspect.signature(inner) and public.__doc__ == inner.__doc__
