"""Calls with arguments that do not fit name the near ones; everything else about a public name is unchanged."""

import inspect
import pickle
from fractions import Fraction

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


def test_an_argument_of_another_call_is_named_with_that_call() -> None:
    with pytest.raises(WrongArguments, match=r"'obstacles'\. Valid .*\. rt\.CollisionFree takes obstacles=\.$"):
        rt.plan(MOVE, obstacles=[])
    with pytest.raises(WrongArguments, match=r"rt\.Phase and rt\.Waypoints take duration=\."):
        rt.plan(MOVE, duration=3.0)
    with pytest.raises(WrongArguments, match=r"rt\.robot\.carrying takes bodies=\."):
        rt.load("ur5", payload=2.0)
    with pytest.raises(WrongArguments, match=r"watch, keep_program\.$"):
        rt.plan(MOVE, zzz=2.0)


def test_arguments_given_by_name_alone_are_printed_so() -> None:
    with pytest.raises(WrongArguments, match=r"rt\.gait\.turn\(robot, angle=\.\.\., "):
        rt.gait.turn(CART)


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


UNUSABLE = {
    "too large": [10**400, -(10**5000), Fraction(10**400)],
    "complex": [1j],
    "surrogate": ["\ud800", "a\udfffb"],
    "entries": [range(10**15)],
}
TAKERS = {
    "Phase.duration": lambda value: rt.Phase(CART, value),
    "Phase.start": lambda value: rt.Phase(CART, 1.0, rt.State(q=value)),
    "State.q": lambda value: rt.Phase(CART, 1.0, rt.State(q=[value, 0.0], v={"pole": value})),
    "between": lambda value: rt.Phase(CART, 1.0, end=rt.State(q=[rt.between(0.0, value), 0.0])),
    "Mesh": lambda value: rt.Mesh([value, 1.0]),
    "weight": lambda value: value * rt.Effort(),
    "divisor": lambda value: rt.Effort() / value,
    "weights": lambda value: rt.Phase(CART, 1.0, None, None, rt.Effort(weights=[value])).dae,
    "margin": lambda value: rt.CollisionFree(margin=value),
    "self_collision": lambda value: rt.CollisionFree(self_collision=value),
    "radius": lambda value: rt.obstacles.Sphere(value),
    "frame": lambda value: CART.frame(value),
    "scheme": lambda value: rt.Mesh(4, value),
    "dynamics": lambda value: rt.Phase(CART, 1.0, dynamics=value),
}


@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize("kind", UNUSABLE)
def test_what_no_double_and_no_file_holds_is_refused_wherever_it_enters(taker: str, kind: str) -> None:
    for value in UNUSABLE[kind]:
        with pytest.raises(rt.InputError) as caught:
            TAKERS[taker](value)
        assert 10 < len(str(caught.value)) < 700


def test_the_argument_that_holds_it_is_named() -> None:
    with pytest.raises(rt.InputError, match=r"upper= of rt.between holds a number that is too large"):
        rt.between(0, [1, 10**400])
    with pytest.raises(rt.InputError, match=r"surrogate stands alone"):
        CART.frame("\ud800")


OTHER_KINDS = {
    "name= of PathConstraint must be text": lambda: rt.PathConstraint(lambda p: p.q[0], 0.0, 1.0, name=["lift"]),
    "unit= of IntegralConstraint must be text": lambda: rt.constraints.IntegralConstraint(abs, 0.0, 1.0, "a", unit=[]),
    "friction of PointContact 'foot' is .*; give a positive number": lambda: rt.PointContact("foot", [0.7]),
    "'lift' has a bound that is 'low'": lambda: move_with(rt.PathConstraint(lambda p: p.q[0], "low", name="lift")),
    "axis= of FrameAxis must be numbers": lambda: rt.constraints.FrameAxis("tip", axis="z"),
    "first= of LinearPath must be numbers": lambda: rt.constraints.LinearPath("tip", ["0", 0, 0], (1, 0, 0)),
    "axis= of Turning must be 3 numbers": lambda: rt.gait.Turning(axis="y"),
    "duration= of StraightLine must be a number": lambda: rt.guess.StraightLine("2 s"),
    "angular= of CentroidalMomentum must be numbers": lambda: rt.objectives.CentroidalMomentum(angular="x"),
    "terminal pose of frame 'tip' must be": lambda: rt.objectives.TerminalPose("tip", None).check(MOVE.body, ()),
    "dynamics= of phase 'phase' is .*Forces on the robot go into contacts=": lambda: MOVE.with_(
        dynamics=rt.ExternalForce("pole", lambda place: [0.0, 0.0, 0.0])
    ),
    "self_collision is 1; give True or False": lambda: rt.CollisionFree(self_collision=1),
}


def move_with(constraint: rt.constraints.Constraint) -> rt.Solution:
    return rt.plan(MOVE.with_(constraints=[constraint]), mesh=rt.Mesh(4))


@pytest.mark.parametrize("text", OTHER_KINDS)
def test_a_value_of_another_kind_is_refused_where_it_is_given(text: str) -> None:
    with pytest.raises(rt.InputError, match=text):
        OTHER_KINDS[text]()
