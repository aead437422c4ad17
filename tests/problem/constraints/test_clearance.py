"""The clearance of points and shapes is that of their lowest point, and may vary along a foot's path."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import coal
import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.problem.constraints.base import symbols_of
from robotraj.witness.point import NumericPoint

SHAPES = {
    "sphere": coal.Sphere(0.07),
    "capsule": coal.Capsule(0.03, 0.2),
    "cylinder": coal.Cylinder(0.05, 0.1),
    "box": coal.Box(0.1, 0.2, 0.04),
    "mesh": coal.BVHModelOBBRSS(),
}
SHAPES["mesh"].beginModel(2, 6)
SHAPES["mesh"].addTriangle(np.array([0.0, 0, 0]), np.array([0.2, 0, 0]), np.array([0, 0.1, 0.0]))
SHAPES["mesh"].addTriangle(np.array([0.0, 0, 0.3]), np.array([0.2, 0.1, 0.3]), np.array([0, 0.1, 0.0]))
SHAPES["mesh"].endModel()
GROUNDS = {"flat": rt.terrain.Flat(0.2), "slope": rt.terrain.Slope(0.3, -0.5, 0.1)}


@dataclass(frozen=True)
class OneShape:
    """Stands for a URDF's collision shapes: one on a link, turned and shifted, and one on the world."""

    shape: Any
    link: str = "tool0"

    def build(self, model: pin.Model, kind: pin.GeometryType) -> pin.GeometryModel:
        shapes = pin.GeometryModel()
        for name, frame in (("floor", 0), ("foot", model.getFrameId(self.link))):
            joint, placement = model.frames[frame].parentJoint, model.frames[frame].placement
            shift = pin.SE3(pin.rpy.rpyToMatrix(0.4, -0.3, 0.9), np.array([0.05, -0.02, 0.1]))
            shapes.addGeometryObject(pin.GeometryObject(name, joint, frame, placement * shift, self.shape))
        return shapes


def rows_at(robot: rt.Robot, constraint: rt.GroundClearance, q: Any, t: float = 0.0, **p: float) -> dict[str, float]:
    """Rows of a clearance at one configuration, from the symbols of the NLP; the witness's numbers agree."""
    phase = rt.Phase(robot, 1.0, limits=None, parameters=p)
    bound = constraint.bind(phase.dae, tuple(p))
    point = symbols_of(phase.dae, tuple(p))
    values = ca.vertcat(*bound.expression(point))
    given = [point.t, ca.vertcat(*point.x.values()), ca.vertcat(*(point.p[name] for name in p))]
    symbolic = ca.Function("rows", given, [values])(t, np.concatenate([q, np.zeros(robot.nv)]), list(p.values()))
    zeros = np.zeros(robot.nv)
    for columns in (True, False):
        numeric = NumericPoint(robot, t, q, zeros, zeros, np.zeros(robot.nu), parameters=p, columns=columns)
        np.testing.assert_allclose([float(v) for v in bound.expression(numeric)], symbolic.full().ravel(), atol=1e-12)
    labels = [row.label for row in bound.rows]
    assert len(labels) == len(set(labels)) == symbolic.numel()
    return dict(zip(labels, symbolic.full().ravel().tolist(), strict=True))


def placement(robot: rt.Robot, frame: str, q: Any) -> pin.SE3:
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, np.asarray(q, dtype=float))
    return data.oMf[robot.frame(frame)].copy()


def surface(shape: Any) -> np.ndarray:
    """Many points of a shape's surface in its own axes."""
    random = np.random.default_rng(0)
    sphere = random.standard_normal((200_000, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    angle = random.uniform(0, 2 * np.pi, 100_000)
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    kind = type(shape).__name__
    if kind == "Sphere":
        return shape.radius * sphere
    if kind == "Capsule":
        return shape.radius * sphere + shape.halfLength * np.sign(sphere[:, 2:]) * [0, 0, 1]
    if kind == "Cylinder":
        return np.vstack([shape.radius * circle + [0, 0, s * shape.halfLength] for s in (-1, 1)])
    if kind == "Box":
        return np.sign(sphere) * shape.halfSide
    return np.array(shape.vertices())


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("kind", SHAPES)
def test_a_shape_is_as_clear_as_its_lowest_point(kind: str, ground: str) -> None:
    robot = replace(rt.load("ur5"), geometry=OneShape(SHAPES[kind]))
    q = [0.3, -1.1, 1.0, 0.4, -0.7, 0.2]
    rows = rows_at(robot, rt.GroundClearance(rt.constraints.CollisionShapes("tool0"), 0.05, GROUNDS[ground]), q)
    assert all(label.startswith("ground clearance, foot") for label in rows)
    world = placement(robot, "tool0", q) * pin.SE3(pin.rpy.rpyToMatrix(0.4, -0.3, 0.9), np.array([0.05, -0.02, 0.1]))
    points = surface(SHAPES[kind]) @ world.rotation.T + world.translation
    lowest = float(np.min(points[:, 2] - GROUNDS[ground].height(points[:, 0], points[:, 1])))
    slack = {"cylinder": 1e-4, "mesh": 0.2, "box": 1e-12}.get(kind, 1e-5)
    assert lowest - slack < min(rows.values()) < lowest + 1e-4
    every = rows_at(robot, rt.GroundClearance(rt.constraints.CollisionShapes(), 0.05, GROUNDS[ground]), q)
    assert every == rows


@pytest.mark.parametrize(("name", "root"), [("solo12", "floating"), ("five_link", "planar"), ("ur5", "fixed")])
def test_shapes_of_a_urdf_move_with_their_links(name: str, root: str) -> None:
    """Their corners and centres are where Pinocchio's geometry has them, locked joints or not."""
    lock = {"left_hip": 0.3} if name == "five_link" else {}
    robot = rt.load(name, root=root, locked=lock)
    random = np.random.default_rng(5)
    q = pin.integrate(robot.model, robot.neutral, random.uniform(-0.5, 0.5, robot.nv))
    shapes, data = robot.collision_model, robot.model.createData()
    placed = pin.GeometryData(shapes)
    pin.updateGeometryPlacements(robot.model, data, shapes, placed, q)
    zeros = np.zeros(robot.nv)
    point = NumericPoint(robot, 0.0, q, zeros, zeros, np.zeros(robot.nu))
    spots = {spot.label: np.array(spot.position(point)) for spot in rt.constraints.CollisionShapes().spots(robot)}
    moving = [
        (shape, pose) for shape, pose in zip(shapes.geometryObjects, placed.oMg, strict=True) if shape.parentJoint
    ]
    assert moving
    for shape, pose in moving:
        of_shape = [
            place for label, place in spots.items() if label == shape.name or label.startswith(f"{shape.name} ")
        ]
        shape.geometry.computeLocalAABB()
        np.testing.assert_allclose(np.mean(of_shape, axis=0), pose.act(shape.geometry.aabb_center), atol=1e-6)


def test_an_upright_cylinders_row_is_smooth_and_on_the_safe_side() -> None:
    shape = coal.Cylinder(0.1, 0.5)
    robot = replace(rt.load("cartpole"), geometry=OneShape(shape, "tip"))
    at = pin.rpy.rpyToMatrix(0.4, -0.3, 0.9)[:, 2]
    phase = rt.Phase(robot, 1.0, limits=None)
    bound = rt.GroundClearance(rt.constraints.CollisionShapes("tip")).bind(phase.dae)
    point = symbols_of(phase.dae, ())
    for tilt in np.linspace(-np.pi, np.pi, 7):
        x = ca.vertcat(*point.x.values())
        rows = ca.vertcat(*bound.expression(point))
        second = ca.Function("h", [x], [ca.hessian(rows[0], x)[0]])([0, tilt, 0, 0])
        assert np.isfinite(np.array(second)).all()
        turned = placement(robot, "tip", [0, tilt])
        center = turned.act(np.array([0.05, -0.02, 0.1]) - 0.25 * at)
        exact = center[2] - 0.1 * np.sqrt(1 - (turned.rotation @ at)[2] ** 2)
        assert exact - 1e-3 <= float(ca.Function("r", [x], [rows[0]])([0, tilt, 0, 0])) <= exact


def test_points_of_a_frame_turn_with_it() -> None:
    robot = rt.load("ur5")
    q = [0.3, -1.1, 1.0, 0.4, -0.7, 0.2]
    ground = rt.terrain.Steps([0.1], [0.0, 0.2])
    clear = rt.GroundClearance(["wrist_1_link", ("tool0", (0.1, 0, -0.02)), ("tool0", [0, 0, 0.5])], ground=ground)
    rows = rows_at(robot, clear, q)
    corner = placement(robot, "tool0", q).act(np.array([0.1, 0, -0.02]))
    assert list(rows)[:2] == ["ground clearance, wrist_1_link", "ground clearance, tool0 (0.1, 0, -0.02)"]
    expected = corner[2] - ground.height(corner[0], corner[1])
    assert rows["ground clearance, tool0 (0.1, 0, -0.02)"] == pytest.approx(expected, abs=1e-12)


def test_a_witness_reads_a_frame_once_for_all_corners_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Converting it again for every entry took validate a minute, where the plan had taken seconds."""
    robot = rt.load("ur5")
    point = NumericPoint(robot, 0.0, robot.neutral, np.zeros(6), np.zeros(6), np.zeros(6), columns=True)
    read, convert = [], point._vector

    def counting(values: Any) -> Any:
        read.append(values.shape)
        return convert(values)

    monkeypatch.setattr(point, "_vector", counting)
    spots = rt.constraints.CollisionShapes("forearm_link").spots(robot)
    places = [np.array(ca.vertcat(*spot.position(point))).ravel() for spot in spots]
    assert len(spots) == 8
    assert sorted(read) == [(3,), (3, 3)]
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.neutral)
    pose = data.oMf[robot.frame("forearm_link")]
    np.testing.assert_allclose(places, [pose.act(np.array(spot.offset)) for spot in spots], atol=1e-14)


def test_a_swing_foot_rises_by_its_progress_between_footholds() -> None:
    robot = rt.load("ur5")
    q = [0.3, -1.1, 1.0, 0.4, -0.7, 0.2]
    x, y, z = placement(robot, "tool0", q).translation
    rows = rows_at(robot, rt.GroundClearance("tool0", rt.constraints.SwingApex(0.08, x - 0.1, x + 0.3)), q)
    assert rows["ground clearance, tool0"] == pytest.approx(z, abs=1e-12)
    assert rows["swing apex, tool0"] == pytest.approx(z - 4 * 0.08 * 0.25 * 0.75, abs=1e-12)
    halfway = rt.constraints.SwingApex(0.08, (x - 0.1, "from"), (x + 0.1, lambda point: point.p["from"] + 2 * point.t))
    rows = rows_at(robot, rt.GroundClearance("tool0", halfway), q, t=0.2, **{"from": y - 0.2})
    assert rows["swing apex, tool0"] == pytest.approx(z - 0.08, abs=1e-12)
    rows = rows_at(robot, rt.GroundClearance("tool0", lambda point: 0.3 * point.t, rt.terrain.Flat(0.1)), q, t=0.5)
    assert rows == {"ground clearance, tool0": pytest.approx(z - 0.25, abs=1e-12)}
    rows = rows_at(robot, rt.GroundClearance("tool0", lambda point: [0.1, point.q[0] ** 2]), q)
    assert list(rows.values()) == pytest.approx([z - 0.1, z - 0.09], abs=1e-12)


@pytest.mark.parametrize("named", [False, True])
def test_a_planned_swing_clears_its_parabola_between_the_points_too(named: bool) -> None:
    held_still = {"shoulder_pan_joint": 0.0, "wrist_1_joint": -1.0, "wrist_2_joint": -1.5, "wrist_3_joint": 0.0}
    robot = rt.load("ur5", locked=held_still)
    low, high = [-1.372, 2.026], [-0.732, 0.985]
    ends = [float(placement(robot, "tool0", q).translation[0]) for q in (low, high)]
    ground = rt.terrain.Flat(0.148)
    parameters = {"start": ends[0], "end": ends[1]} if named else {}
    apex = rt.constraints.SwingApex(0.2, "start", "end") if named else rt.constraints.SwingApex(0.2, *ends)
    given = {"start": rt.State(q=low, v=0), "end": rt.State(q=high, v=0), "objective": rt.Effort()}
    clear = rt.GroundClearance("tool0", apex, ground)
    closely = rt.interval_limits.ConstraintGeneration(1e-4)
    phase = rt.Phase(robot, 1.0, constraints=[clear], parameters=parameters, **given)
    solution = rt.plan(phase, rt.Mesh(8), interval_limits=closely)
    free = rt.plan(rt.Phase(robot, 1.0, **given), rt.Mesh(6))

    def least(solution: rt.Solution, times: np.ndarray) -> float:
        tips = np.array([placement(robot, "tool0", q).translation for q in solution.at(times).q])
        s = (tips[:, 0] - ends[0]) / (ends[1] - ends[0])
        return float(np.min(tips[:, 2] - ground.level - np.maximum(0.2 * 4 * s * (1 - s), 0)))

    assert least(free, free.phases[0].points) < -0.1
    # Inside an interval the position is the integral of the speed, which the scheme's order sets apart from the rows.
    assert -1e-6 < least(solution, solution.knots) < 2e-3
    assert least(solution, solution.phases[0].points) > -2e-4
    assert least(solution, np.linspace(0, 1, 1001)) > -5e-4
    assert solution.added_rows and not solution.interval_violations
    assert solution.objective > free.objective


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: rt.GroundClearance([]), ["no frame"]),
        (lambda: rt.GroundClearance(3), ["3", "rt.constraints.CollisionShapes"]),
        (lambda: rt.GroundClearance(("tool0", (0, 0, np.nan))), ["tool0", "nan", "three metres"]),
        (lambda: rt.GroundClearance(["tool0", "tol0"]), ["tol0", "tool0"]),
        (lambda: rt.GroundClearance(rt.constraints.CollisionShapes("tol0")), ["tol0", "tool0"]),
        (
            lambda: rt.GroundClearance(rt.constraints.CollisionShapes("tool0")),
            ["no collision shape", "on tool0", "forearm_link"],
        ),
        (
            lambda: rt.GroundClearance(rt.constraints.CollisionShapes("base_link")),
            ["no collision shape that moves on base_link"],
        ),
        (lambda: rt.GroundClearance("tool0", "high"), ["tool0", "high", "rt.constraints.SwingApex"]),
        (lambda: rt.GroundClearance("tool0", rt.constraints.SwingApex(0.1, "form", 1.0)), ["parameter", "form"]),
        (lambda: rt.constraints.SwingApex(0.0, 0, 1), ["apex", "positive"]),
        (lambda: rt.constraints.SwingApex(0.1, 1.0, 1.0), ["two different footholds"]),
        (lambda: rt.constraints.SwingApex(0.1, 1.0, (1.0, 2.0)), ["(1.0, 2.0)", "for both"]),
        (lambda: rt.constraints.SwingApex(0.1, (1.0, 2.0, 3.0), 1.0), ["start", "foothold"]),
        (lambda: rt.constraints.SwingApex(0.1, np.nan, 1.0), ["start", "nan"]),
    ],
)
def test_what_cannot_be_kept_clear_is_named(make: Any, words: list[str]) -> None:
    with pytest.raises(rt.InputError) as error:
        rt.Phase(rt.load("ur5"), 1.0, constraints=[make()]).bound_constraints  # noqa: B018
    for word in words:
        assert word in str(error.value)


def test_shapes_of_another_kind_and_robots_without_shapes_are_named() -> None:
    cone = replace(rt.load("ur5"), geometry=OneShape(coal.Cone(0.1, 0.2)))
    with pytest.raises(rt.InputError, match="'foot' of ur5 is a Cone"):
        rt.Phase(cone, 1.0, constraints=[rt.GroundClearance(rt.constraints.CollisionShapes())]).bound_constraints  # noqa: B018
    bare = rt.load(rt.load("ur5").model)
    with pytest.raises(rt.InputError, match="no collision shape"):
        rt.Phase(bare, 1.0, constraints=[rt.GroundClearance(rt.constraints.CollisionShapes())]).bound_constraints  # noqa: B018
