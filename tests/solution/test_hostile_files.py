"""Files from untrusted sources: every fault raises one InputError that names the file and the place, within 5 s."""

from __future__ import annotations

import io
import json
import time
import tracemalloc
import warnings
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.solution.storage.entries import MOST_BYTES
from robotraj.solution.violation import Violation

SECONDS = 5.0

Change = Callable[[dict[str, Any]], None]


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    robot = rt.load("cartpole")
    phase = rt.Phase(
        robot,
        (1.5, 2.5),
        rt.State(q=0, v=0),
        rt.State(q=[1, np.pi], v=0),
        rt.Effort() + 0.1 * rt.Duration(),
        constraints=[rt.GroundClearance("tip", -0.6, rt.terrain.Slope(0.1))],
    )
    return rt.plan(phase, mesh=rt.Mesh(8)).save(tmp_path_factory.mktemp("saved") / "good.npz")


def attempt(path: Path) -> rt.Solution | None:
    """Load a file and read what a user would; return None where it was refused properly."""
    start = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            solution = rt.load_solution(path)
            _ = repr(solution), solution.at(np.linspace(0.0, solution.duration, 5))
        except rt.InputError as error:
            assert path.name in str(error) or "t = " in str(error), error
            solution = None
    assert time.perf_counter() - start < SECONDS
    return solution


def changed(source: Path, target: Path, change: Change) -> Path:
    """Write the file again with other JSON or arrays."""
    with np.load(source) as archive:
        entries: dict[str, Any] = {name: archive[name] for name in archive.files}
    entries["solution"] = json.loads(str(entries["solution"]))
    change(entries)
    if isinstance(entries["solution"], dict):
        entries["solution"] = np.array(json.dumps(entries["solution"]))
    np.savez(target, **{name: value for name, value in entries.items() if value is not None})
    return target


def fields_of(entries: dict[str, Any]) -> dict[str, Any]:
    """The fields of the only robot."""
    return entries["solution"]["problem"]["robots"][0]["fields"]


def model_of(entries: dict[str, Any]) -> dict[str, Any]:
    return fields_of(entries)["model"]["$model"]


def put(path: str, value: Any) -> Change:
    """Change one place of the JSON."""

    def change(entries: dict[str, Any]) -> None:
        *way, last = path.split("/")
        inside = entries["solution"]
        for key in way:
            inside = inside[int(key)] if isinstance(inside, list) else inside[key]
        if isinstance(inside, list):
            inside[int(last)] = value
        else:
            inside[last] = value

    return change


def array(name: str, make: Callable[[np.ndarray], Any]) -> Change:
    """Change one stored array."""

    def change(entries: dict[str, Any]) -> None:
        entries[name] = make(entries[name])

    return change


def nested(entries: dict[str, Any]) -> None:
    """Put lists inside lists, as deep as JSON is read."""
    value: Any = 0
    for _ in range(150):
        value = {"$list": [value]}
    entries["solution"]["facts"] = {"message": value}


X = "phases.0.trajectory.x"
ROBOT = "problem/robots/0/fields"
CHANGES: dict[str, Change] = {
    "a missing array": array(f"{X}.values", lambda _: None),
    "no knots": array(f"{X}.breaks", lambda a: a[:0]),
    "knots that are not numbers": array(f"{X}.breaks", lambda a: a * np.nan),
    "knots in another order": array(f"{X}.breaks", lambda a: a[::-1]),
    "too few values": array(f"{X}.values", lambda a: a[:-1]),
    "values of another number of variables": array(f"{X}.values", lambda a: a[:, :-1]),
    "text for numbers": array(f"{X}.values", lambda a: a.astype("U8")),
    "complex numbers": array(f"{X}.values", lambda a: a + 0j),
    "a scalar": array(f"{X}.values", lambda a: np.array(1.0)),
    "deep recursion": nested,
    "no problem": put("problem", None),
    "no phases": put("problem/phases", []),
    "a robot that is none": put("problem/robots/0", {"$class": "State", "fields": {}}),
    "no such robot": put("problem/phases/0/robot", 7),
    "a cache": put("problem/phases/0/fields/start", {"$class": "Cache", "fields": {"folder": {"$path": "/tmp/x"}}}),
    "a class with its module": put("facts/proof", {"$class": "robotraj.__main__.X", "fields": {}}),
    "an unknown mark": put("facts/proof", {"$evil": 1}),
    "two marks": put("facts/proof", {"$list": [], "$tuple": []}),
    "an unknown field": put(f"{ROBOT}/evil", 1),
    "a status that is none": put("facts/status", {"$enum": "Status", "member": "__class__"}),
    "text for a status": put("facts/status", "solved"),
    "text for seconds": put("facts/times", {"solve": "long"}),
    "iterations that are none": put("facts/iterations", "many"),
    "a huge mesh": put("phases/0/mesh/fields/intervals", 10**9),
    "a mesh of another size": put("phases/0/mesh/fields/intervals", 9),
    "a duration that is not a number": put("phases/0/trajectory/fields/duration", {"$float": "nan"}),
    "gains that are none": put("facts/gains", {"phases": 3}),
    "lengths that do not fit": put("phases/0/trajectory/fields/x/fields/values/lengths", [10**12]),
    "negative lengths": put("phases/0/trajectory/fields/x/fields/values/lengths", [-1] * 8),
    "a joint that is its own parent": put(f"{ROBOT}/model/$model/parents/$list/0", 1),
    "a parent that comes later": put(f"{ROBOT}/model/$model/parents/$list/1", 9),
    "an unknown joint": put(f"{ROBOT}/model/$model/joints/$list/0/kind", "JointModelEvil"),
    "a joint that is a function": put(f"{ROBOT}/model/$model/joints/$list/0/kind", "buildModelFromUrdf"),
    "two joints of one name": put(f"{ROBOT}/model/$model/joint_names", {"$list": ["pole", "pole"]}),
    "a joint without a name": put(f"{ROBOT}/model/$model/joint_names/$list/0", None),
    "a frame of no joint": put(f"{ROBOT}/model/$model/frames/$list/0/$list/1", 99),
    "a frame of no type": put(f"{ROBOT}/model/$model/frames/$list/0/$list/3", 3),
    "Boost's archive": put(f"{ROBOT}/model/$model", "22 serialization::archive 19 0 0 0"),
    "a negative mass": array("robots.0.model.inertias", lambda a: -a),
    "an inertia that is not a number": array("robots.0.model.inertias", lambda a: a * np.nan),
    "a rotation that is none": array("robots.0.model.placements", lambda a: 2 * a),
    "placements of another number": array("robots.0.model.placements", lambda a: a[:1]),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES.keys())
def test_every_damage_is_one_error_with_its_place(change: Change, saved: Path, tmp_path: Path) -> None:
    path = changed(saved, tmp_path / "hostile.npz", change)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(rt.InputError, match=r"hostile\.npz'.*(phases|problem|facts|robots|settings)"):
            rt.load_solution(path)
    assert attempt(path) is None
    assert [entry.name for entry in tmp_path.iterdir()] == ["hostile.npz"]


def test_the_unchanged_file_loads(saved: Path, tmp_path: Path) -> None:
    assert attempt(changed(saved, tmp_path / "same.npz", lambda entries: None)) is not None


def test_flipped_bits_are_refused_or_harmless(saved: Path, tmp_path: Path) -> None:
    good, rng, refused = saved.read_bytes(), np.random.default_rng(0), 0
    for k in range(150):
        data = bytearray(good)
        for place in rng.integers(0, len(good), rng.integers(1, 5)):
            data[place] ^= 1 << rng.integers(0, 8)
        path = tmp_path / f"flipped{k}.npz"
        path.write_bytes(bytes(data))
        refused += attempt(path) is None
    assert refused > 100


def test_flipped_bits_inside_sound_entries_are_refused_or_harmless(saved: Path, tmp_path: Path) -> None:
    """Behind the checksums of the archive: each entry is changed, then packed rightly."""
    rng = np.random.default_rng(1)
    with zipfile.ZipFile(saved) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    for k in range(150):
        name = str(rng.choice(list(entries)))
        data = bytearray(entries[name])
        for place in rng.integers(0, min(len(data), 4000), rng.integers(1, 4)):
            data[place] ^= 1 << rng.integers(0, 7)
        path = tmp_path / f"entry{k}.npz"
        with zipfile.ZipFile(path, "w") as archive:
            for entry, content in entries.items():
                archive.writestr(entry, bytes(data) if entry == name else content)
        attempt(path)


def test_cut_files_are_refused(saved: Path, tmp_path: Path) -> None:
    good = saved.read_bytes()
    for k, share in enumerate(np.linspace(0.0, 0.999, 40)):
        path = tmp_path / f"cut{k}.npz"
        path.write_bytes(good[: int(share * len(good))])
        assert attempt(path) is None


def test_the_bytes_of_a_damaged_name_are_not_repeated(saved: Path, tmp_path: Path) -> None:
    """The header of an entry claims a name of 60 kB; the message once held as many bytes of the file."""
    with zipfile.ZipFile(saved) as archive:
        place = archive.infolist()[3].header_offset
    data, path = bytearray(saved.read_bytes()), tmp_path / "named.npz"
    data[place + 26 : place + 28] = (60_000).to_bytes(2, "little")
    path.write_bytes(data)
    with pytest.raises(rt.InputError, match="named.npz.*is damaged") as caught:
        rt.load_solution(path)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize("field", ["format", "version", "robotraj"])
def test_long_words_of_a_file_are_not_repeated(field: str, saved: Path, tmp_path: Path) -> None:
    """A message had the 5,000 letters that a file called its version."""

    def change(entries: dict[str, Any]) -> None:
        about = json.loads(str(entries["about"]))
        about |= {"version": 0} if field == "robotraj" else {}
        entries["about"] = np.array(json.dumps(about | {field: 5000 * "x"}))

    with pytest.raises(rt.InputError, match="xxx") as refusal:
        rt.load_solution(changed(saved, tmp_path / "long.npz", change))
    assert len(str(refusal.value)) < 500 + len(str(tmp_path))


def test_a_long_name_of_a_missing_entry_is_not_repeated(saved: Path, tmp_path: Path) -> None:
    def change(entries: dict[str, Any]) -> None:
        text = json.dumps(entries["solution"])
        first = next(name for name in entries if name.endswith("x.values"))
        assert json.dumps(first) in text
        entries["solution"] = json.loads(text.replace(json.dumps(first), json.dumps(5000 * "x")))

    with pytest.raises(rt.InputError, match="missing entry") as refusal:
        rt.load_solution(changed(saved, tmp_path / "long.npz", change))
    assert len(str(refusal.value)) < 500 + len(str(tmp_path))


@pytest.mark.filterwarnings("ignore:.*was loaded without")
@pytest.mark.parametrize("damage", ["missing", "unknown", "swapped", "text"])
def test_a_motion_has_the_parameters_of_its_phase(damage: str, tmp_path: Path) -> None:
    """A missing one was found by the compiled module, at the first sample: "c has 88 entries, expected 96"."""
    system = rt.System(["x", "v"], ["u"], lambda p: [p.x["v"], p.u["u"] * p.p["gain"] - p.p["drag"]])
    values = {"gain": rt.between(1, 2), "drag": rt.between(0.5, 1)}
    effort = rt.Lagrange(lambda p: p.u["u"] ** 2)
    phase = rt.Phase(system, 1.0, rt.State([0, 0]), rt.State([1, 0]), effort, parameters=values)
    source = rt.plan(phase, rt.Mesh(5)).save(tmp_path / "good.npz")

    def change(entries: dict[str, Any]) -> None:
        (motion,) = (part["trajectory"] for part in _mappings(entries["solution"]) if "trajectory" in part)
        parameters = next(part["parameters"] for part in _mappings(motion) if "parameters" in part)
        gain = parameters.pop("gain")
        if damage == "unknown":
            parameters["loss"] = gain
        elif damage == "swapped":
            parameters["gain"] = gain
        elif damage == "text":
            kept = dict(parameters)
            parameters.clear()
            parameters.update({"gain": "much"} | kept)

    assert rt.load_solution(source).success
    with pytest.raises(rt.InputError, match="is damaged"):
        rt.load_solution(changed(source, tmp_path / "bad.npz", change))


def _mappings(data: Any) -> Iterator[dict[str, Any]]:
    """Yield every mapping of a JSON value."""
    if isinstance(data, dict):
        yield data
    for each in data.values() if isinstance(data, dict) else data if isinstance(data, list) else ():
        yield from _mappings(each)


def test_every_missing_entry_is_refused(saved: Path, tmp_path: Path) -> None:
    with np.load(saved) as archive:
        names = list(archive.files)
    for k, name in enumerate(names):
        path = changed(saved, tmp_path / f"{k}.npz", lambda entries, name=name: entries.update({name: None}))
        loaded = attempt(path)
        # Settings alone may be lost.
        assert loaded is None or (name.startswith("settings") and loaded.settings is None), name


def test_a_bomb_is_refused_before_it_is_unpacked(saved: Path, tmp_path: Path) -> None:
    path = tmp_path / "bomb.npz"
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("a.npy", "w", force_zip64=True) as file,
    ):
        zeros = bytes(2**24)
        for _ in range(MOST_BYTES // len(zeros) + 1):
            file.write(zeros)
    assert path.stat().st_size < 2**20
    tracemalloc.start()
    with pytest.raises(rt.InputError, match="bytes are read"):
        rt.load_solution(path)
    assert tracemalloc.get_traced_memory()[1] < 2**24
    tracemalloc.stop()


@pytest.mark.parametrize("shape", [(10**15,), (2**40, 2**40), (-1,), (3, 0, 2**62)])
def test_a_header_that_claims_more_than_follows_is_refused(shape: tuple[int, ...], tmp_path: Path) -> None:
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
    path = tmp_path / "shape.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("about.npy", header.getvalue() + bytes(8))
    with pytest.raises(rt.InputError, match=r"shape\.npz' .* its entry 'about\.npy' is damaged"):
        rt.load_solution(path)


def repeat_the_phase(entries: dict[str, Any]) -> None:
    entries["solution"]["problem"]["phases"] *= 2_000


def test_phases_without_a_motion_are_refused_before_they_are_made(saved: Path, tmp_path: Path) -> None:
    path = changed(saved, tmp_path / "many.npz", repeat_the_phase)
    began = time.process_time()
    with pytest.raises(rt.InputError, match="holds 1 motions for 2000 phases"):
        rt.load_solution(path)
    assert time.process_time() - began < SECONDS


@pytest.mark.parametrize("text", ["[" * 100_000, "{" * 5000, '{"problem": NaN}', "9" * 10_000, "[]", "null", '"a"', ""])
def test_json_that_is_none_of_ours_is_refused(text: str, saved: Path, tmp_path: Path) -> None:
    path = changed(saved, tmp_path / "json.npz", lambda entries: entries.update(solution=np.array(text)))
    assert attempt(path) is None


def test_a_command_and_a_folder_are_neither_kept_nor_set(saved: Path, tmp_path: Path) -> None:
    solution = rt.load_solution(saved)
    assert solution.settings is not None

    def compiled(entries: dict[str, Any]) -> None:
        fields = entries["solution"]["settings"]["fields"]
        fields["engine"] = {"$class": "Compiled", "fields": {"compiler": "touch /tmp/evil"}}

    def options(entries: dict[str, Any]) -> None:
        fields = entries["solution"]["settings"]["fields"]
        fields["solver"] = {"$class": "Ipopt", "fields": {"options": {"output_file": "/tmp/evil"}}}

    for k, change in enumerate((compiled, options)):
        path = changed(saved, tmp_path / f"{k}.npz", change)
        with pytest.warns(UserWarning, match="settings of the plan could not be read"):
            assert rt.load_solution(path).settings is None


def test_a_path_where_pairs_of_links_belong_is_not_read(saved: Path, tmp_path: Path) -> None:
    avoid = {"name": "x", "value": {"$class": "CollisionFree", "fields": {"obstacles": {"$tuple": []}, "srdf": "/x"}}}
    path = changed(saved, tmp_path / "hostile.npz", put("problem/phases/0/constraints", [avoid]))
    with pytest.raises(rt.InputError, match="srdf of CollisionFree is a path"):
        rt.load_solution(path)


def test_no_urdf_is_read_for_the_points_of_collision_shapes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    low = rt.GroundClearance([rt.constraints.CollisionShapes("cart")], -9.0)
    phase = rt.Phase(rt.load("cartpole"), 1.0, rt.State(q=0, v=0), rt.State(q=0, v=0), constraints=[rt.AtStart(low)])
    path = rt.plan(phase, mesh=rt.Mesh(3)).save(tmp_path / "low.npz")
    monkeypatch.setattr("robotraj.robot.loading.geometry.read_xml", None)
    loaded = rt.load_solution(path).problem.phases[0]
    assert loaded.constraints == phase.constraints
    assert [row.name for row in loaded.rows] == [row.name for row in phase.rows]


def test_a_file_does_not_make_paths_trusted(tmp_path: Path) -> None:
    urdf = tmp_path / "own.urdf"
    urdf.write_text(rt.load("pendulum").geometry.urdf.read_text())
    for robot, trusted in ((rt.load(urdf, trust_paths=True), False), (rt.load("pendulum"), True)):
        phase = rt.Phase(robot, 1.0, rt.State(q=0, v=0), rt.State(q=0.1, v=0), rt.Effort())
        path = rt.plan(phase, mesh=rt.Mesh(3)).save(tmp_path / "plan.npz")
        assert rt.load_solution(path).problem.phases[0].robot.geometry.trust_paths is trusted


def test_a_violation_without_a_size_is_infinite() -> None:
    """A file can state it; the page once ended in ZeroDivisionError."""
    assert Violation("swing", "effort limit", "elbow", 0.0, 1.0, "N m", 0.0, "over", size=0.0).relative == np.inf
