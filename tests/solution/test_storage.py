"""Saving and loading returns the same solution: data bit for bit, classes and functions by name."""

from __future__ import annotations

import inspect
import json
import pkgutil
import warnings
from dataclasses import dataclass, fields, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import robotraj as rt
from robotraj.dynamics.contacts.base import Contact
from robotraj.dynamics.contacts.cones import FrictionCone
from robotraj.dynamics.contacts.soles import Sole
from robotraj.dynamics.design.quantity import Quantity
from robotraj.dynamics.terrain.base import Ground
from robotraj.native.engines.base import Engine
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.bounds import Between
from robotraj.problem.constraints.joint_limits import JointLimit
from robotraj.problem.links.base import Link
from robotraj.problem.objectives.base import Objective, Sum
from robotraj.robot.coupling.coupled_model import coupled
from robotraj.robot.coupling.mimics import Mimic
from robotraj.robot.loading.geometry import NoGeometry
from robotraj.solution.storage.classes import CLASSES
from robotraj.solution.storage.models import model_data, model_of
from robotraj.solution.storage.packing import Packer
from robotraj.solution.storage.plain_data import NotPlainData
from robotraj.solution.storage.unpacking import Unpacker
from robotraj.solvers.base import Multipliers, Solver
from robotraj.transcription.refinement.base import Refinement
from robotraj.transcription.schemes.collocation import Scheme
from tests.robot.coupling.random_trees import random_tree


def there_and_back(value: Any) -> Any:
    packer = Packer()
    text = json.dumps(packer.pack(value, "value"), allow_nan=False)
    return Unpacker(packer.arrays).unpack(json.loads(text))


def packed(value: Any) -> tuple[Any, dict[str, bytes]]:
    """All of a value in a form that compares bit for bit."""
    packer = Packer()
    return packer.pack(value, "value"), {name: array.tobytes() for name, array in packer.arrays.items()}


@pytest.fixture(scope="module")
def cartpole() -> rt.Solution:
    robot = rt.load("cartpole")
    phase = rt.Phase(
        robot,
        duration=(1.5, 2.5),
        start=rt.State(q=[0, 0], v=0),
        end=rt.State(q={"slider": rt.between(0.8, 1.0), "pole": np.pi}, v=[0, None]),
        objective=rt.Effort() + 0.1 * rt.Duration(),
        constraints=[
            rt.GroundClearance("tip", -0.6, rt.terrain.Slope(0.1)),
            rt.AtEnd(rt.FramePosition("tip", {"z": rt.between(0, 2)})),
        ],
        parameters={"mass": rt.between(1, 2)},
        limits=robot.limits.with_(effort=15.0),
        name="swing-up",
    )
    mesh = rt.Mesh([0, 0.3, 0.5, 1], [rt.HermiteSimpson(), rt.schemes.LobattoIIIA(6), rt.schemes.RadauIIA(5)])
    return rt.plan(phase, mesh)


def block_phase(**changes: Any) -> rt.Phase:
    system = rt.System(
        states=["x", "v"],
        controls=["u"],
        algebraic=["f"],
        dynamics=lambda point: [point.x["v"], point.z["f"]],
        residual=lambda point: [point.z["f"] - point.u["u"]],
        units={"x": "m", "v": "m/s", "u": "N"},
        name="block",
    )
    known: dict[str, Any] = {
        "duration": (0.1, 20),
        "start": rt.State({"x": 0, "v": 0}),
        "end": rt.State({"x": 10, "v": 0}),
        "controls": {"u": rt.between(-1, 1)},
        "objective": rt.Duration(),
        "name": "move",
    }
    return rt.Phase(system, **(known | changes))


@pytest.fixture(scope="module")
def block() -> rt.Solution:
    return rt.plan(block_phase(), rt.Mesh(10, rt.HermiteSimpson(control=rt.schemes.ConstantControl())))


def polynomials(solution: rt.Solution) -> list[bytes]:
    return [
        array.tobytes()
        for part in solution.phases
        for curve in (part.trajectory.x, part.trajectory.z, part.trajectory.u)
        for array in (curve.breaks, *curve.sites, *curve.values)
    ]


def test_the_polynomials_survive_bit_for_bit(cartpole: rt.Solution, tmp_path: Path) -> None:
    loaded = rt.load_solution(cartpole.save(tmp_path / "swing.npz"))
    assert polynomials(loaded) == polynomials(cartpole)
    times = np.linspace(0, cartpole.duration, 57)
    for name in ("q", "v", "a", "tau"):
        assert np.array_equal(getattr(loaded.at(times), name), getattr(cartpole.at(times), name))


def test_every_fact_of_the_solution_survives(cartpole: rt.Solution, tmp_path: Path) -> None:
    loaded = rt.load_solution(cartpole.save(tmp_path / "swing.npz"))
    for entry in fields(cartpole):
        if entry.name not in ("problem", "phases"):
            known = getattr(cartpole, entry.name)
            known = known.plain if isinstance(known, Multipliers) else known
            assert packed(getattr(loaded, entry.name)) == packed(known), entry.name
    assert loaded.multipliers is not None and loaded.multipliers.rows.size > 0
    assert str(loaded) == str(cartpole) and loaded.parameters == cartpole.parameters
    (part,), (known,) = loaded.phases, cartpole.phases
    assert part.mesh == known.mesh
    assert np.array_equal(part.points, known.points)


def test_the_problem_of_a_robot_survives_whole(cartpole: rt.Solution, tmp_path: Path) -> None:
    path = cartpole.save(tmp_path / "swing.npz")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        loaded = rt.load_solution(path)
    phase, known = loaded.problem.phases[0], cartpole.problem.phases[0]
    assert str(loaded.problem) == str(cartpole.problem)
    assert phase.constraints == known.constraints
    assert phase.start == known.start and phase.end == known.end
    assert phase.robot is not None and known.robot is not None
    assert phase.robot.model == known.robot.model
    assert phase.robot.visual_model.ngeoms == known.robot.visual_model.ngeoms > 0


def test_a_force_without_unknowns_that_a_file_does_not_hold_leaves_the_samples(tmp_path: Path) -> None:
    push = rt.ExternalForce("tip", lambda place: [0.0, 2.0, 0.0])
    ends = rt.State(q=[0, 0.3], v=0), rt.State(q=[0.4, -0.2], v=0)
    phase = rt.Phase(rt.load("two_link_arm"), 2.0, *ends, rt.Effort(), contacts=[push], limits=None)
    solution = rt.plan(phase, rt.Mesh(6), progress=False)
    with pytest.warns(UserWarning, match="ExternalForce"):
        loaded = rt.load_solution(solution.save(tmp_path / "pushed.npz"))
    assert np.array_equal(loaded.at(0.5).q, solution.at(0.5).q)
    assert np.array_equal(loaded.at(0.5).forces["tip"], np.zeros(3))
    with pytest.raises(rt.InputError, match="ExternalForce.* are Python functions, which a file does not hold"):
        rt.validate(loaded)


def test_a_loaded_solution_warm_starts_and_proves_like_the_first(cartpole: rt.Solution, tmp_path: Path) -> None:
    loaded = rt.load_solution(cartpole.save(tmp_path / "swing.npz"))
    again = rt.plan(loaded.problem, loaded.phases[0].mesh, guess=loaded)
    assert again.objective == pytest.approx(cartpole.objective, rel=1e-6)
    assert again.iterations < cartpole.iterations
    assert rt.validate(loaded).drift.worst == rt.validate(cartpole).drift.worst


def test_the_file_contains_the_model_so_the_urdf_may_be_deleted(tmp_path: Path) -> None:
    urdf = tmp_path / "mine.urdf"
    text = next(entry.urdf for entry in rt.robot.catalogue() if entry.name == "block").read_text()
    urdf.write_text(text.replace('robot name="block"', 'robot name="mine"'))
    robot = rt.load(urdf)
    phase = rt.Phase(robot, duration=5.0, start=rt.State(q=0, v=0), end=rt.State(q=1, v=0), objective=rt.Effort())
    path = rt.plan(phase, rt.Mesh(5)).save(tmp_path / "mine.npz")
    urdf.unlink()
    with pytest.warns(UserWarning, match="URDF of 'mine' is gone"):
        loaded = rt.load_solution(path)
    found = loaded.problem.phases[0].robot
    assert found is not None and found.model == robot.model
    assert found.visual_model.ngeoms == 0
    assert rt.validate(loaded).passed


def test_a_robot_of_the_catalogue_finds_its_shapes_where_they_are_now(cartpole: rt.Solution, tmp_path: Path) -> None:
    phase = cartpole.problem.phases[0]
    assert phase.robot is not None
    elsewhere = replace(phase.robot.geometry, urdf=tmp_path / "gone" / "cartpole.urdf")  # type: ignore[type-var]
    moved = replace(phase, subject=replace(phase.robot, geometry=elsewhere), limits=phase.limits)
    parts = tuple(replace(part, phase=moved) for part in cartpole.phases)
    path = replace(cartpole, problem=rt.Problem([moved]), phases=parts).save(tmp_path / "swing.npz")
    loaded = rt.load_solution(path).problem.phases[0].robot
    assert loaded is not None and loaded.visual_model.ngeoms > 0


def test_phases_share_their_robot_and_links_come_back(tmp_path: Path) -> None:
    robot = rt.load("block")
    first = rt.Phase(robot, duration=2.0, start=rt.State(q=0, v=0), objective=rt.Effort(), name="first")
    second = rt.Phase(robot, duration=3.0, end=rt.State(q=1, v=0), objective=rt.Effort(), name="second")
    solution = rt.plan(rt.Problem([first, second], links=[rt.Continuity(0, 1)]), rt.Mesh(4))
    loaded = rt.load_solution(solution.save(tmp_path / "two"))
    one, two = loaded.problem.phases
    assert one.robot is two.robot
    assert loaded.problem.links == (rt.Continuity(0, 1),)
    assert polynomials(loaded) == polynomials(solution)
    assert loaded.phases[1].t0 == 2.0


def test_a_refined_solution_keeps_its_history(tmp_path: Path) -> None:
    phase = rt.Phase(
        rt.load("pendulum"),
        duration=2.5,
        start=rt.State(q=0, v=0),
        end=rt.State(q=np.pi, v=0),
        objective=rt.Effort(),
    )
    solution = rt.plan(phase, tolerance=1e-4)
    loaded = rt.load_solution(solution.save(tmp_path / "refined"))
    assert loaded.refinement == solution.refinement and len(loaded.refinement) > 1


def test_a_failed_solution_keeps_its_status_and_violations(tmp_path: Path) -> None:
    phase = block_phase(duration=3.0)
    solution = rt.plan(phase, rt.Mesh(5), check=False)
    assert not solution.success and solution.violation_list
    loaded = rt.load_solution(solution.save(tmp_path / "failed"), problem=phase)
    assert loaded.status is solution.status
    assert loaded.violation_list == solution.violation_list


def test_a_system_loads_without_its_equations_and_raises_on_use(block: rt.Solution, tmp_path: Path) -> None:
    path = block.save(tmp_path / "block")
    with pytest.warns(UserWarning, match=r"without the equations of system 'block'.*problem="):
        loaded = rt.load_solution(path)
    assert polynomials(loaded) == polynomials(block)
    assert loaded.at(1.0).x["v"] == block.at(1.0).x["v"]
    assert str(loaded.problem) == str(block.problem)
    with pytest.raises(rt.InputError, match=r"equations of system 'block'.*problem="):
        rt.validate(loaded)


def test_a_system_with_its_problem_is_whole(block: rt.Solution, tmp_path: Path) -> None:
    phase = block.problem.phases[0]
    path = block.save(tmp_path / "block")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        loaded = rt.load_solution(path, problem=phase)
    assert loaded.problem.phases[0] is phase
    assert rt.validate(loaded).passed


def test_functions_are_listed_by_name_and_the_rest_is_kept(tmp_path: Path) -> None:
    phase = block_phase(
        constraints=[rt.PathConstraint(lambda point: point.x["v"] * point.u["u"], upper=50, name="power", unit="W")],
        objective=rt.Duration() + 0.5 * rt.Lagrange(lambda point: 1e-3 * point.u["u"] ** 2) + 2 * rt.Effort(),
    )
    path = rt.plan(phase, rt.Mesh(5)).save(tmp_path / "block")
    with pytest.warns(UserWarning) as caught:
        loaded = rt.load_solution(path)
    (message,) = [str(warning.message) for warning in caught]
    assert "constraint PathConstraint(expression=<lambda>, upper=50, name='power', unit='W')" in message
    assert "objective 0.5 Lagrange(expression=<lambda>) of phase 'move'" in message
    assert " at 0x" not in message and "locals" not in message
    assert loaded.problem.phases[0].objective == Sum(((1.0, rt.Duration()), (2.0, rt.Effort())))
    assert loaded.problem.phases[0].constraints == ()


def test_a_height_function_is_left_out_with_its_constraint(tmp_path: Path) -> None:
    robot = rt.load("cartpole")
    hills = rt.GroundClearance("tip", -2.0, ground=lambda x, y: 0.1 * x)
    kept = rt.GroundClearance("tip", -2.0)
    phase = rt.Phase(
        robot,
        duration=1.0,
        start=rt.State(q=0, v=0),
        end=rt.State(q=[0.1, 0], v=0),
        constraints=[hills, kept],
    )
    path = rt.plan(phase, rt.Mesh(5)).save(tmp_path / "hills")
    with pytest.warns(UserWarning, match="without constraint GroundClearance.*<lambda>"):
        loaded = rt.load_solution(path)
    assert loaded.problem.phases[0].constraints == (kept,)


def every_constraint() -> list[Constraint]:
    limits = {"slider": Between(-1.5, None), "pole": Between(-1, np.array(2.0))}
    pose = pin.SE3(pin.Quaternion(0.0, 0.6, 0.0, 0.8).matrix(), np.array([0.1, 0.0, 1 / 3]))
    return [
        *(kind(limits) for kind in sorted(JointLimit.__subclasses__(), key=lambda kind: kind.__name__)),
        rt.GroundClearance(["tip", "cart"], 0.05, rt.terrain.Flat(-0.0)),
        rt.GroundClearance(
            [rt.constraints.CollisionShapes("cart"), ("tip", (0.1, 0, 0))],
            rt.constraints.SwingApex(0.1, "from", 1.0),
            rt.terrain.Steps([0.0], [0, 0.1]),
        ),
        rt.AtStart(rt.FramePosition("tip", [None, rt.between(0, np.inf), 0.1])),
        rt.FramePose("tip", (np.array([0.1, 0.2, 0.3]), np.array([0.0, 0.0, 0.0, 1.0]))),
        rt.FramePose("tip", pose),
    ]


@pytest.mark.parametrize("constraint", every_constraint(), ids=lambda c: type(c).__name__)
def test_every_constraint_of_plain_data_survives(constraint: Constraint) -> None:
    copy = there_and_back(constraint)
    assert type(copy) is type(constraint)
    assert repr(copy) == repr(constraint)


def test_a_height_map_survives() -> None:
    hills = rt.terrain.HeightMap(np.arange(20.0).reshape(4, 5) ** 2, (0.1, 0.2), (1 / 3, -0.0))
    assert there_and_back(rt.GroundClearance("tip", ground=hills)) == rt.GroundClearance("tip", ground=hills)


@dataclass(frozen=True)
class Mine(Constraint):
    """A constraint of the user, which is not on the allow-list."""

    gains: dict[str, tuple[float, ...]]

    def bind(self, dynamics: Any, parameters: Any = ()) -> Any:
        raise AssertionError("not needed here")


def test_a_class_outside_the_list_is_neither_written_nor_made() -> None:
    mine = Mine({"slider": (0.1, np.inf)})
    with pytest.raises(NotPlainData, match="a Mine, a class that files do not hold"):
        Packer().pack([mine], "mine")
    with pytest.raises(NotPlainData, match="a Mine, a class that is not made from files"):
        Unpacker({}).unpack({"$class": "Mine", "fields": {"gains": {}}})


def _is_kept(kind: type) -> bool:
    """Whether users construct values of the class; higher rooms define internal classes for one solve."""
    above = ("robotraj.indirect.", "robotraj.fixed_mesh.", "robotraj.planning.", "tests.")
    return kind.__module__.startswith("robotraj.") and not (
        kind.__module__.startswith(above) or inspect.isabstract(kind)
    )


def test_every_value_of_a_problem_that_is_plain_data_is_on_the_list() -> None:
    """A new constraint, objective, link, contact or scheme is entered in the list, or named here."""
    functions = {"HeightFunction", "HeightOf"}
    families = (
        Constraint,
        Objective,
        Link,
        Contact,
        Ground,
        Scheme,
        Solver,
        Refinement,
        Engine,
        Quantity,
        FrictionCone,
        Sole,
    )
    for family in families:
        kinds = [family]
        for kind in kinds:
            kinds += kind.__subclasses__()
        plain = {k.__name__ for k in kinds if _is_kept(k)}
        internal = {
            "JointLimit",
            "RateLimit",
            "FrameMotionLimit",
            "Term",
            "Integral",
            "EndCost",
            "Shot",
            "Shooting",
            "Objective",
        }
        assert plain - set(CLASSES) - functions - internal - {name for name in plain if name[0] == "_"} == set(), family


@pytest.mark.parametrize("value", [0.1, -0.0, 5e-324, 1.7976931348623157e308, 1 / 3, np.inf, -np.inf, np.nan])
def test_floats_survive_bit_for_bit(value: float) -> None:
    assert np.float64(there_and_back(value)).tobytes() == np.float64(value).tobytes()


def test_containers_keep_their_kind() -> None:
    value = {"a": [1, (2.5, None, True)], "b": (), "c": {"d": "text"}, "e": [np.arange(3.0), np.ones(1)]}
    copy = there_and_back(value)
    assert [part.tolist() for part in copy.pop("e")] == [part.tolist() for part in value.pop("e")]
    assert copy == value


def test_what_is_no_data_is_refused_and_stores_nothing() -> None:
    packer = Packer()
    with pytest.raises(NotPlainData, match=r"x\.b"):
        packer.pack({"a": np.ones(3), "b": len}, "x")
    assert packer.arrays == {}


def test_expressions_of_gaits_are_on_the_list() -> None:
    """A gait is saved whole: what its constraints and objectives call is plain data."""
    names = [f"robotraj.gait.{entry.name}" for entry in pkgutil.iter_modules(rt.gait.__path__)]
    kinds = [kind for name in names for kind in vars(import_module(name)).values() if isinstance(kind, type)]
    called = {kind.__name__ for kind in kinds if kind.__module__ in names and "__call__" in vars(kind)}
    assert called and called <= set(CLASSES)


def test_no_class_is_found_by_module() -> None:
    for name in ("os.system", "builtins.eval", "robotraj.native.engines.cache.Cache", "pathlib.Path", "Path", "Cache"):
        with pytest.raises(NotPlainData, match="not made from files"):
            Unpacker({}).unpack({"$class": name, "fields": {}})


@pytest.mark.parametrize("name", ["cartpole", "ur5", "panda", "solo12", "talos", "g1"])
def test_models_survive_as_numbers(name: str) -> None:
    model = rt.load(name).model
    assert there_and_back(model) == model


def test_composite_and_tilted_joints_survive() -> None:
    model = pin.Model()
    both = pin.JointModelComposite(2)
    both.addJoint(pin.JointModelRX(), pin.SE3.Random())
    both.addJoint(pin.JointModelPrismaticUnaligned(np.array([0.6, 0.0, 0.8])), pin.SE3.Random())
    for joint in (both, pin.JointModelHelicalUnaligned(np.array([0.0, 0.6, 0.8]), 0.3), pin.JointModelHX(0.2)):
        number = model.addJoint(model.njoints - 1, joint, pin.SE3.Random(), f"joint {model.njoints}")
        model.appendBodyToJoint(number, pin.Inertia.Random(), pin.SE3.Identity())
        model.addJointFrame(number)
    again = there_and_back(model)
    assert again == model
    q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
    assert np.array_equal(pin.crba(model, model.createData(), q), pin.crba(again, again.createData(), q))


def test_a_bare_model_has_no_shapes_to_lose(tmp_path: Path) -> None:
    model = rt.load("block").model.copy()
    robot = rt.load(model)
    assert isinstance(robot.geometry, NoGeometry)
    phase = rt.Phase(robot, duration=5.0, start=rt.State(q=0, v=0), end=rt.State(q=1, v=0))
    loaded = rt.load_solution(rt.plan(phase, rt.Mesh(3)).save(tmp_path / "bare"))
    assert loaded.problem.phases[0].robot is not None
    assert loaded.problem.phases[0].robot.model == robot.model


def test_the_suffix_is_added_once_and_plain_numpy_reads_the_file(
    block: rt.Solution, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert block.save("a") == block.save("a.npz") == tmp_path / "a.npz"
    assert block.save("v1.2") == tmp_path / "v1.2.npz"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.npz", "v1.2.npz"]
    with np.load("a.npz", allow_pickle=False) as archive:
        about = json.loads(str(archive["about"]))
        assert about["format"] == "robotraj solution" and about["version"] == 4 and "robotraj" in about
        assert archive["phases.0.trajectory.x.breaks"].shape == (11,)
    with pytest.warns(UserWarning):
        assert rt.load_solution("a").duration == block.duration


def rewritten(source: Path, target: Path, **changes: Any) -> Path:
    with np.load(source) as archive:
        entries = {name: archive[name] for name in archive.files}
    np.savez(target, **{name: value for name, value in (entries | changes).items() if value is not None})
    return target


def test_files_that_are_not_ours_are_refused(block: rt.Solution, tmp_path: Path) -> None:
    path = block.save(tmp_path / "good")
    with pytest.raises(rt.InputError, match=r"no file '.*missing\.npz'"):
        rt.load_solution(tmp_path / "missing.npz")
    other = tmp_path / "other.npz"
    np.savez(other, x=np.ones(3))
    text, array, pickled = tmp_path / "text.npz", tmp_path / "array.npz", tmp_path / "pickled.npz"
    text.write_text("hello")
    with array.open("wb") as file:
        np.save(file, np.ones(3))
    np.savez(pickled, about=np.array([{}], dtype=object))
    empty = tmp_path / "empty.npz"
    empty.touch()
    cut = tmp_path / "cut.npz"
    cut.write_bytes(path.read_bytes()[:-200])
    for wrong in (other, text, array, pickled, empty, cut):
        with pytest.raises(rt.InputError, match="holds no robotraj solution"):
            rt.load_solution(wrong)
    foreign = rewritten(path, tmp_path / "foreign.npz", about=np.array('{"format": "maps", "version": 1}'))
    with pytest.raises(rt.InputError, match="'maps'"):
        rt.load_solution(foreign)


def test_another_version_is_refused_and_named(block: rt.Solution, tmp_path: Path) -> None:
    about = np.array(json.dumps({"format": "robotraj solution", "version": 99, "robotraj": "7.0"}))
    path = rewritten(block.save(tmp_path / "good"), tmp_path / "new.npz", about=about)
    with pytest.raises(rt.InputError, match=r"version 99.*robotraj 7\.0.*reads version 4"):
        rt.load_solution(path)


@pytest.mark.parametrize(
    ("place", "name", "message"),
    [
        (("phases", 0), "given_name", r"phases\.0: PhaseSolution has no field 'given_name' in files"),
        (("facts",), "speed", "facts: Solution has no field 'speed' in files"),
    ],
)
def test_a_file_of_a_robotraj_with_other_classes_is_not_called_damaged(
    block: rt.Solution, tmp_path: Path, place: tuple[Any, ...], name: str, message: str
) -> None:
    """A class that lost a field since the file was written; the same fault under the own classes is damage."""
    path = block.save(tmp_path / "own")
    with np.load(path) as archive:
        about, data = (json.loads(str(archive[entry])) for entry in ("about", "solution"))
    own = about["robotraj"]
    for classes in (about["classes"], "0123456789abcdef", None):
        other = json.loads(json.dumps(data))
        part = other
        for key in place:
            part = part[key]
        part[name] = 1.0
        header = {**about, "robotraj": "0.0.7", "classes": classes}
        changed = rewritten(
            path, tmp_path / "other.npz", about=np.array(json.dumps(header)), solution=np.array(json.dumps(other))
        )
        with pytest.raises(rt.InputError, match=message) as error, pytest.warns(UserWarning):
            rt.load_solution(changed)
        text = str(error.value)
        if classes == about["classes"]:
            assert "is damaged" in text and "0.0.7" not in text
        else:
            assert "damaged" not in text
            assert f"0.0.7 wrote the file with other classes than those of the running one ({own})" in text


def test_settings_of_other_classes_are_left_out_with_both_versions(cartpole: rt.Solution, tmp_path: Path) -> None:
    path = cartpole.save(tmp_path / "own")
    with np.load(path) as archive:
        about, data = (json.loads(str(archive[entry])) for entry in ("about", "solution"))
    data["settings"]["fields"]["given_name"] = 1.0
    header = {**about, "robotraj": "0.0.7", "classes": "0123456789abcdef"}
    changed = rewritten(
        path, tmp_path / "other.npz", about=np.array(json.dumps(header)), solution=np.array(json.dumps(data))
    )
    with pytest.warns(UserWarning, match=r"settings of the plan could not be read: .*Robotraj 0\.0\.7 wrote the file"):
        assert rt.load_solution(changed).objective == cartpole.objective


def test_a_damaged_file_raises_an_error(block: rt.Solution, tmp_path: Path) -> None:
    good = block.save(tmp_path / "good")
    path = rewritten(good, tmp_path / "bad.npz", **{"phases.0.trajectory.x.values": None})
    with pytest.raises(rt.InputError, match="damaged"):
        rt.load_solution(path, problem=block.problem)


def test_a_problem_that_does_not_fit_is_refused(block: rt.Solution, cartpole: rt.Solution, tmp_path: Path) -> None:
    path = block.save(tmp_path / "block")
    with pytest.raises(rt.InputError, match=r"phase 'move' has the states \['x', 'v'\].*q\.slider"):
        rt.load_solution(path, problem=cartpole.problem)
    two = rt.Problem([block_phase(), block_phase()])
    with pytest.raises(rt.InputError, match="has 1 phases, but problem= has 2"):
        rt.load_solution(path, problem=two)


def test_saving_where_nothing_can_be_saved_is_refused(block: rt.Solution, tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match="directory .*absent' does not exist"):
        block.save(tmp_path / "absent" / "a.npz")
    (tmp_path / "folder.npz").mkdir()
    with pytest.raises(rt.InputError, match="is a directory"):
        block.save(tmp_path / "folder.npz")


def test_a_contact_on_a_function_is_saved_without_its_equations(tmp_path: Path) -> None:
    robot = rt.load("hopper", root="planar")
    stand = {"root_x": 0.0, "root_z": 0.5, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
    phase = rt.Phase(
        robot,
        duration=0.2,
        contacts=[rt.PointContact("foot", ground=lambda x, y: 0.0 * x)],
        start=rt.State(q=stand, v=0),
        name="stand",
    )
    solution = rt.plan(phase, mesh=rt.Mesh(3))
    path = solution.save(tmp_path / "stand.npz")
    with pytest.warns(UserWarning, match=r"without the equations of contact PointContact\(frame='foot'"):
        loaded = rt.load_solution(path)
    np.testing.assert_array_equal(loaded.at(0.1).q, solution.at(0.1).q)
    with pytest.raises(rt.InputError, match="equations of contact PointContact"):
        rt.validate(loaded)
    assert rt.load_solution(path, problem=phase).phases[0].phase is phase


def test_what_is_given_anew_is_no_longer_missing(tmp_path: Path) -> None:
    """A constraint and an objective that cannot be saved, passed again when loading."""
    slow = rt.PathConstraint(lambda p: p.v[0], upper=5.0, name="slow")
    cost = rt.Effort() + rt.Lagrange(lambda p: p.v[1] ** 2)
    phase = rt.Phase(
        rt.load("cartpole"), 2.0, rt.State(q=0, v=0), rt.State(q=[1, np.pi], v=0), cost, constraints=[slow]
    )
    saved = rt.plan(phase, rt.Mesh(8)).save(tmp_path / "plan")
    with pytest.warns(UserWarning, match="slow"):
        known = rt.load_solution(saved)
    assert len(known.problem.missing) == 2
    assert known.problem.with_(end=phase.end).missing == known.problem.missing
    (objective,) = known.problem.with_(constraints=[slow]).missing
    assert objective.startswith("objective ")
    again = rt.plan(known.problem.with_(constraints=[slow], objective=cost), rt.Mesh(8), guess=known)
    assert not again.problem.missing
    assert again.error is not None
    assert not rt.validate(again).unchecked


def test_a_file_of_too_many_values_is_refused_at_once():
    """A million terms of an objective took 20 s before they were refused."""
    many = {"$list": [{"$float": "inf"}] * 100_001}
    with pytest.raises(rt.InputError, match="100000 values"):
        Unpacker({}).unpack(many)


def test_a_robot_whose_joints_follow_others_comes_back(tmp_path: Path) -> None:
    robot = rt.load(coupled(*random_tree(5)))
    again = there_and_back(robot)
    assert again.followers == robot.followers and again.limits.joints == robot.limits.joints
    q, v, a = np.random.default_rng(0).normal(size=(3, robot.nv))
    torques = [pin.rnea(each.model, each.model.createData(), q, v, a) for each in (again, robot)]
    np.testing.assert_allclose(*torques, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"leader": "nobody"}, "no leader before it"),
        ({"leader": "follower"}, "no leader before it"),
        ({"multiplier": 0.0}, "does not follow"),
        ({"multiplier": float("nan")}, "does not follow"),
        ({"joint": {"kind": "JointModelFreeFlyer"}}, "several positions"),
    ],
)
def test_followers_of_a_hostile_file_are_refused(change: dict[str, Any], fault: str) -> None:
    model = pin.Model()
    for name in ("leader", "follower"):
        joint = model.addJoint(0, pin.JointModelPX(), pin.SE3.Identity(), name)
        model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    data = model_data(coupled(model, [Mimic("follower", "leader", -1.0, 0.0)]))
    data["joints"][1] |= change  # type: ignore[index]
    with pytest.raises(ValueError, match=fault):
        model_of(data)


@pytest.mark.parametrize("name", ["{0.__class__}", "{a", "{}", "$\\frac{1}{2}$", "%s"])
def test_braces_in_the_name_of_a_phase_are_letters(name: str, tmp_path: Path) -> None:
    """The names of what is stored were once put into a template with the name of the phase in it."""
    ends = rt.State(q=0, v=0), rt.State(q=0.5, v=0)
    swing = rt.Phase(rt.load("pendulum"), 1.0, *ends, rt.Effort(), [rt.GroundClearance("tip", -3.0)], name=name)
    solution = rt.plan(swing, mesh=rt.Mesh(4), check=False)
    assert rt.load_solution(solution.save(tmp_path / "named.npz")).phases[0].phase.name == name


def test_a_problem_file_is_no_solution_but_has_one(tmp_path):
    (tmp_path / "p.toml").write_text("[robot]")
    with pytest.raises(rt.InputError, match=r"it is a problem file: robotraj plan .*p.toml --save motion.npz"):
        rt.load_solution(tmp_path / "p.toml")
