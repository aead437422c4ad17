"""Two plans in one cell: the least delay of a closed form, distances judged by coal, and robots in the way."""

import coal
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt

SIDE, CLEARANCE = 0.2, 0.05
SLIDER = f"""<robot name="slider"><link name="base"/>
<link name="cube"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="{SIDE} {SIDE} {SIDE}"/></geometry></collision></link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="cube"/><axis xyz="AXIS"/>
<limit lower="-5" upper="5" velocity="10" effort="100"/></joint></robot>"""


def slide(folder, axis, begin, end, duration=2.0):
    """Plan the least effort of a cube on a rail: begin + (end - begin) (3 s^2 - 2 s^3)."""
    file = folder / f"{axis.replace(' ', '')}.urdf"
    file.write_text(SLIDER.replace("AXIS", axis))
    robot = rt.load(file)
    return rt.plan(rt.Phase(robot, duration, rt.State(q=begin, v=0), rt.State(q=end, v=0), rt.Effort()))


def place(begin, end, duration, times):
    """Return the position of such a cube, which rests before and after."""
    s = np.clip(times / duration, 0.0, 1.0)
    return begin + (end - begin) * s**2 * (3.0 - 2.0 * s)


def least_distance(delay, first, second):
    """Return the least distance of the cubes on rails x and y, (begin, end, duration) each."""
    times = np.linspace(0.0, 8.0, 20001)
    x, y = place(*first, times), place(*second, times - delay)
    return np.hypot(np.maximum(np.abs(x) - SIDE, 0.0), np.maximum(np.abs(y) - SIDE, 0.0)).min()


@pytest.mark.parametrize("seed", range(3))
def test_the_delay_is_the_least_that_keeps_the_clearance(tmp_path, seed):
    rng = np.random.default_rng(seed)
    first = (-rng.uniform(0.5, 1.0), rng.uniform(0.5, 1.0), rng.uniform(1.0, 3.0))
    second = (-rng.uniform(0.5, 1.0), rng.uniform(0.5, 1.0), first[2])
    plans = slide(tmp_path, "1 0 0", *first), slide(tmp_path, "0 1 0", *second)
    cell = rt.share_cell(*plans, clearance=CLEARANCE)
    assert least_distance(0.0, first, second) < CLEARANCE
    assert least_distance(cell.delay, first, second) > CLEARANCE - 1e-6
    shorter = [least_distance(share * (cell.delay - 0.01), first, second) for share in np.linspace(0.0, 1.0, 40)]
    assert max(shorter) < CLEARANCE
    name, distance, time = cell.nearest
    assert set(name.split(" and ")) == {"first_cube", "second_cube"} and 0.0 < time < cell.duration
    assert distance == pytest.approx(least_distance(cell.delay, first, second), abs=5e-3)


def test_motions_that_never_meet_begin_together(tmp_path):
    plans = slide(tmp_path, "1 0 0", -1.0, 1.0), slide(tmp_path, "0 1 0", -1.0, 1.0)
    cell = rt.share_cell(*plans, at={"second": (3.0, 0.0, 0.0)}, clearance=CLEARANCE)
    assert cell.delay == 0.0
    assert cell.duration == pytest.approx(2.0)
    np.testing.assert_allclose(cell.positions([0.0, 2.0, 9.0]), [[-1, -1], [1, 1], [1, 1]], atol=1e-9)


def test_a_robot_at_rest_in_the_way_is_named_with_the_order_that_helps(tmp_path):
    across, leaving = slide(tmp_path, "1 0 0", -1.0, 1.0), slide(tmp_path, "0 1 0", 0.0, 1.0, 4.0)
    with pytest.raises(rt.InputError, match="second robot at its start stands in the way.*has a delay of") as refused:
        rt.share_cell(across, leaving, clearance=CLEARANCE)
    named = float(str(refused.value).rsplit("delay of ", 1)[1].split(" s")[0])
    assert rt.share_cell(leaving, across, clearance=CLEARANCE).delay == pytest.approx(named, abs=1e-3)
    arriving = slide(tmp_path, "0 1 0", -1.0, 0.0)
    late = slide(tmp_path, "1 0 0", -1.0, 1.0, 4.0)
    with pytest.raises(rt.InputError, match="first robot at its end stands in the way.*has a delay of"):
        rt.share_cell(arriving, late, clearance=CLEARANCE)
    staying = slide(tmp_path, "0 1 0", 0.0, 0.01)
    with pytest.raises(rt.InputError, match="In the other order a robot at rest"):
        rt.share_cell(across, staying, clearance=CLEARANCE)


def test_other_input_is_refused(tmp_path):
    plan = slide(tmp_path, "1 0 0", -1.0, 1.0)
    for clearance in (0.0, -1.0, np.nan, "far"):
        with pytest.raises(rt.InputError, match="clearance of a shared cell"):
            rt.share_cell(plan, plan, clearance=clearance)
    with pytest.raises(rt.InputError, match="two plans that were solved"):
        rt.share_cell(plan, "plan")
    phase = plan.phases[0].phase
    moving = rt.plan(phase.with_(end=rt.State(q=1.0, v=1.0)))
    with pytest.raises(rt.InputError, match="second motion moves at its end"):
        rt.share_cell(plan, moving)


@pytest.mark.slow
def test_links_of_two_arms_stay_apart_by_coal(tmp_path):
    ur5 = rt.load("ur5")
    home = np.array([0.0, -1.3, 1.6, -1.9, -1.57, 0.0])

    def swing(begin, end):
        return rt.retime(np.array([home + [turn, 0, 0, 0, 0, 0] for turn in (begin, end)]), ur5)

    first, second = swing(-1.2, 1.2), swing(np.pi - 1.2, np.pi + 1.2)
    cell = rt.share_cell(first, second, at={"second": (0.9, 0.0, 0.0)}, clearance=0.03)
    assert 0.0 < cell.delay < first.duration
    model, shapes = cell.robot.model, cell.robot.collision_model
    data, placed = model.createData(), shapes.createData()
    own = [model.frames[shape.parentFrame].name.startswith("first_") for shape in shapes.geometryObjects]
    pairs = [(i, j) for i in range(len(own)) for j in range(len(own)) if own[i] and not own[j]]

    def apart(delay):
        least = np.inf
        for t in np.linspace(0.0, cell.duration, 150):
            q = [plan.at(np.clip(s, 0.0, plan.duration)).q for plan, s in ((first, t), (second, t - delay))]
            pin.updateGeometryPlacements(model, data, shapes, placed, np.concatenate(q))
            places = [coal.Transform3s(each.rotation, each.translation) for each in placed.oMg]
            solids = [each.geometry for each in shapes.geometryObjects]
            for i, j in pairs:
                request, result = coal.DistanceRequest(), coal.DistanceResult()
                least = min(least, coal.distance(solids[i], places[i], solids[j], places[j], request, result))
        return least

    assert apart(cell.delay) >= 0.03
    assert apart(0.0) < 0.03
