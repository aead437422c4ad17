"""Programs of moves: deviations within the radii, exact lines and arcs, continuity, less time than with stops."""

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

HOME = np.array([0.2, -1.6, 1.2, -1.2, -1.57, 0.0])


def pose(robot, q, frame="tool0"):
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return pin.SE3(data.oMf[robot.frame(frame)])


@pytest.fixture(scope="module")
def arm():
    return rt.load("ur5", limits={"acceleration": 15.0})


@pytest.fixture(scope="module")
def place(arm):
    return pose(arm, HOME).translation


@pytest.fixture(scope="module")
def mixed(arm, place):
    """Lines, an arc, and moves of the joints, with a blend of every kind."""
    turned = pose(arm, HOME).rotation @ pin.exp3(np.array([0.2, 0.1, 0.4]))
    return [
        rt.MoveL(place + [0, 0, -0.2], radius=0.04),
        rt.MoveL((place + [0, 0.2, -0.2], turned), radius=0.03),
        rt.MoveC(place + [-0.1, 0.3, -0.2], place + [-0.2, 0.2, -0.2], radius=0.02),
        rt.MoveJ(HOME + 0.1, radius=0.05),
        rt.MoveJ(HOME, radius=0.06),
        rt.MoveL(place + [0, 0, -0.1]),
    ]


def curves(program):
    return {phase.name: phase.path.curve for phase in program.phases}


def samples(curve, count=50):
    return curve(np.linspace(curve.breaks[0], curve.breaks[-1], count))


def test_blends_stay_in_the_balls_and_leave_the_moves_at_their_radius(arm, mixed):
    found = curves(rt.Program(arm, HOME, mixed, tool="tool0"))
    sharp = curves(rt.Program(arm, HOME, [type(m)(**{**vars(m), "radius": 0.0}) for m in mixed], tool="tool0"))
    for number, move in enumerate(mixed[:-1]):
        end = sharp[f"move {number}"]
        corner = pose(arm, end(end.breaks[-1])).translation
        away = [np.linalg.norm(pose(arm, q).translation - corner) for q in samples(found[f"blend {number}"])]
        assert max(away) <= move.radius * (1 + 1e-6)
        assert max(away[0], away[-1]) > 0.8 * move.radius


def test_positions_and_two_derivatives_are_continuous_from_stop_to_stop(arm, mixed):
    ways = [phase.path.curve for phase in rt.Program(arm, HOME, mixed, tool="tool0").phases]
    for before, after in zip(ways, ways[1:], strict=False):
        for _ in range(3):
            gap = before(before.breaks[-1]) - after(after.breaks[0])
            assert np.abs(gap).max() < 1e-7 * max(1.0, *(np.abs(v).max() for v in before.values))
            before, after = before.derivative(), after.derivative()


def test_lines_are_straight_and_turn_in_proportion(arm, place):
    first = pose(arm, HOME)
    last = pin.SE3(first.rotation @ pin.exp3(np.array([0.3, -0.2, 0.5])), place + [0.1, -0.1, -0.2])
    (curve,) = curves(rt.Program(arm, HOME, [rt.MoveL(last)], tool="tool0")).values()
    for q in samples(curve):
        here = pose(arm, q)
        share = (here.translation - place) @ (last.translation - place) / np.sum((last.translation - place) ** 2)
        assert np.linalg.norm(here.translation - place - share * (last.translation - place)) < 2e-6
        wanted = first.rotation @ pin.exp3(share * pin.log3(first.rotation.T @ last.rotation))
        assert np.linalg.norm(pin.log3(wanted.T @ here.rotation)) < 2e-5


def test_arcs_are_circles_through_the_middle(arm, place):
    middle, last = place + [0.1, 0.0, -0.1], place + [0.0, 0.0, -0.2]
    (curve,) = curves(rt.Program(arm, HOME, [rt.MoveC(middle, last)], tool="tool0")).values()
    places = np.array([pose(arm, q).translation for q in samples(curve, 101)])
    centre = place + [0.0, 0.0, -0.1]
    assert np.allclose(np.linalg.norm(places - centre, axis=1), 0.1, atol=2e-6)
    assert np.linalg.norm(places[50] - middle) < 2e-6


def test_a_redundant_arm_returns_to_the_posture_where_a_closed_way_began():
    arm = rt.load("panda", locked={"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0})
    start = np.array([0.0, -0.5, 0.0, -2.2, 0.0, 1.9, 0.8])
    at = pose(arm, start, "panda_hand").translation
    corners = [[0.1, 0.1, -0.2], [0.1, -0.2, -0.2], [0.0, 0.0, 0.0]]
    moves = [rt.MoveL(at + corner, radius=0.03 * (k < 2)) for k, corner in enumerate(corners)]
    *_, last = curves(rt.Program(arm, start, moves, tool="panda_hand")).values()
    assert np.allclose(last(last.breaks[-1]), start, atol=1e-8)


@pytest.mark.slow
def test_blends_save_time_and_are_proved(arm, place):
    down, aside = place + [0, 0, -0.2], place + [0, 0.2, -0.2]
    blended, stopped = (
        rt.plan(rt.Program(arm, HOME, [rt.MoveL(down, r), rt.MoveL(aside, r), rt.MoveJ(HOME)], tool="tool0"))
        for r in (0.05, 0.0)
    )
    assert blended.proof.holds and stopped.proof.holds
    assert blended.duration < 0.97 * stopped.duration
    assert rt.validate(blended).passed


def test_accelerations_are_continuous_at_blends_under_a_limit_of_jerk(arm, place):
    moves = [rt.MoveL(place + [0, 0, -0.2], radius=0.04), rt.MoveL(place + [0, 0.2, -0.2])]
    program = rt.Program(arm, HOME, moves, tool="tool0", constraints=[rt.constraints.JointJerk(200.0)])
    solution = rt.plan(program)
    assert solution.proof.holds
    t = np.linspace(0.0, solution.duration, 4001)
    a = solution.at(t).a
    assert np.abs(np.diff(a, axis=0)).max() / t[1] < 200.0 * 1.01
    assert np.abs(a[[0, -1]]).max() < 1e-6


def test_poses_are_targets_of_joint_moves(arm, place):
    target = pin.SE3(pose(arm, HOME).rotation, place + [0.0, 0.1, -0.1])
    (curve,) = curves(rt.Program(arm, HOME, [rt.MoveJ(target)], tool="tool0")).values()
    reached = pose(arm, curve(curve.breaks[-1]))
    assert np.linalg.norm(pin.log6(target.actInv(reached)).vector) < 1e-7
    assert len(curve.breaks) == 2


def test_a_program_is_saved_and_loaded(arm, place, tmp_path):
    solution = rt.plan(rt.Program(arm, HOME, [rt.MoveL(place + [0, 0, -0.1])], tool="tool0"), check=False)
    solution.save(tmp_path / "program.npz")
    assert rt.load_solution(tmp_path / "program.npz").duration == solution.duration


def test_programs_that_cannot_be_run_are_refused(arm, place):
    down = place + [0, 0, -0.2]
    for moves, message in (
        ([], "moves"),
        ([rt.MoveL(down, radius=0.1)], "last move"),
        ([rt.MoveL(place)], "ends where it begins"),
        ([rt.MoveL(place + [0, 0, 3.0])], "does not reach"),
        ([rt.MoveC(place + [0, 0, -0.1], down)], "on one line"),
        (
            [rt.MoveL(down, radius=0.15), rt.MoveL(down + [0.1, 0, 0], radius=0.08), rt.MoveL(down + [0.1, 0.1, 0])],
            "too short",
        ),
        ([rt.MoveJ(HOME + [0, 0, 0, 0, 0, 7.0])], "position limit"),
    ):
        with pytest.raises(rt.InputError, match=message):
            rt.Program(arm, HOME, moves, tool="tool0")
    with pytest.raises(rt.InputError, match="radius"):
        rt.MoveL(down, radius=-0.1)
    with pytest.raises(rt.UnknownName, match="tool"):
        rt.Program(arm, HOME, [rt.MoveL(down)], tool="tol0")
