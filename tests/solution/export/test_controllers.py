"""Files of controllers hold the plan at strictly ascending times, the ends included exactly."""

import csv
import json

import numpy as np
import pytest
import yaml

import robotraj as rt
from robotraj.solution.export.times import sample_times

DURATION = 0.50037  # no multiple of a millisecond


@pytest.fixture(scope="module")
def plan():
    arm = rt.load("two_link_arm")
    phase = rt.Phase(arm, DURATION, rt.State(q=0, v=0), rt.State(q=[0.4, -0.3], v=0), rt.Effort(), limits=None)
    return rt.plan(phase, mesh=rt.Mesh(10))


@pytest.mark.parametrize("rate", [1.0, 7.3, 100.0, 1000.0, 999.999])
@pytest.mark.parametrize("end", [0.5, 0.50037, 1.0, 1.0 / 3.0, 2.0000000001])
def test_times_ascend_from_start_to_end(rate, end):
    times = sample_times(0.25, 0.25 + end, 0, rate)
    assert times[0] == 0.25 and times[-1] == 0.25 + end
    steps = np.diff(times)
    assert (steps > 0).all()
    np.testing.assert_allclose(steps[:-1], 1.0 / rate, rtol=1e-9)
    assert steps[-1] < 1.002 / rate


def test_a_plan_of_no_whole_number_of_periods_ends_at_rest(plan, tmp_path):
    path = plan.to_csv(tmp_path / "arm.csv", rate=1000.0)
    with path.open() as file:
        header, *rows = csv.reader(file)
    table = np.array(rows, dtype=float)
    assert table[-1, 0] == DURATION
    velocities = [i for i, name in enumerate(header) if name.startswith("v.")]
    assert np.abs(table[-1, velocities]).max() < 1e-9


@pytest.mark.parametrize(("suffix", "read"), [(".json", json.loads), (".yaml", yaml.safe_load)])
def test_joint_trajectory(plan, tmp_path, suffix, read):
    message = read(plan.to_controller(tmp_path / f"arm{suffix}", rate=100.0).read_text())
    assert message["joint_names"] == list(plan.phases[0].phase.robot.actuated)
    points = message["points"]
    stamps = [point["time_from_start"]["sec"] * 10**9 + point["time_from_start"]["nanosec"] for point in points]
    assert stamps[0] == 0 and stamps[-1] == round(DURATION * 1e9) and (np.diff(stamps) > 0).all()
    sample = plan.at(0.01)
    np.testing.assert_array_equal(points[1]["positions"], sample.q)
    np.testing.assert_array_equal(points[1]["velocities"], sample.v)
    np.testing.assert_array_equal(points[1]["accelerations"], sample.a)
    np.testing.assert_array_equal(points[1]["effort"], sample.tau)
    np.testing.assert_allclose(points[-1]["positions"], [0.4, -0.3], atol=1e-9)


def test_yaml_has_numbers_where_a_mantissa_has_no_point(tmp_path):
    ends = rt.State(q=[1e-5, 0], v=0), rt.State(q=[0.4, -2e-7], v=0)
    phase = rt.Phase(rt.load("two_link_arm"), DURATION, *ends, rt.Effort(), limits=None)
    file = rt.plan(phase, mesh=rt.Mesh(10)).to_controller(tmp_path / "arm.yaml", rate=20.0)
    points = yaml.safe_load(file.read_text())["points"]
    assert points[0]["positions"] == [1e-5, 0.0]
    assert points[-1]["positions"] == pytest.approx([0.4, -2e-7], abs=1e-12)
    lists = (point[name] for point in points for name in ("positions", "velocities", "accelerations", "effort"))
    assert all(isinstance(value, float) for values in lists for value in values)


def test_tables_of_set_points(plan, tmp_path):
    with plan.to_controller(tmp_path / "arm.csv", rate=200.0).open() as file:
        header, *rows = csv.reader(file)
    joints = plan.phases[0].phase.robot.actuated
    assert header[:3] == ["t [s]", f"q.{joints[0]} [rad]", f"q.{joints[1]} [rad]"]
    assert header[-1] == f"tau.{joints[1]} [N m]"
    table = np.array(rows, dtype=float)
    servo = np.loadtxt(plan.to_controller(tmp_path / "arm.servo", rate=200.0))
    assert servo.shape == (len(table), 6)
    np.testing.assert_allclose(servo, table[:, [1, 2, 3, 4, 7, 8]], rtol=1e-8, atol=1e-12)


def test_an_mcap_file_holds_the_plan_until_its_end(plan, tmp_path):
    reader = pytest.importorskip("mcap.reader", reason="needs the extra: pip install 'robotraj[mcap]'")
    path = plan.to_controller(tmp_path / "arm.mcap", rate=50.0)
    with path.open("rb") as file:
        messages = [(m.log_time, json.loads(m.data)) for _, _, m in reader.make_reader(file).iter_messages()]
    assert messages[-1][0] == round(DURATION * 1e9)
    np.testing.assert_array_equal(messages[1][1]["position"], plan.at(0.02).q)


def test_roots_are_left_out(tmp_path):
    solo = rt.load("solo12")
    phase = rt.Phase(solo, 0.1, rt.State(v=0), objective=rt.Effort(), limits=None)
    solution = rt.plan(phase, mesh=rt.Mesh(3), check=False)
    message = json.loads(solution.to_controller(tmp_path / "solo.json", rate=100.0).read_text())
    assert message["joint_names"] == list(solo.actuated)
    assert len(message["points"][0]["positions"]) == len(solo.actuated)


def test_bad_input(plan, tmp_path):
    with pytest.raises(rt.InputError, match="writes"):
        plan.to_controller(tmp_path / "arm.bag")
    with pytest.raises(rt.InputError, match="rate"):
        plan.to_controller(tmp_path / "arm.csv", rate=0.0)
    with pytest.raises(rt.InputError, match="does not exist; create it"):
        plan.to_controller(tmp_path / "absent" / "arm.csv")
    system = rt.System(["x"], ["u"], lambda point: [point.u["u"]])
    drift = rt.Phase(system, 1.0, rt.State({"x": 0}), rt.State({"x": 1}), rt.Lagrange(lambda p: p.u["u"] ** 2))
    with pytest.raises(rt.InputError, match="System"):
        rt.plan(drift, mesh=rt.Mesh(3)).to_controller(tmp_path / "drift.csv")
