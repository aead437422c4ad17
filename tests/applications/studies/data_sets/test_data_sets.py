"""Data sets hold the planned motions at their rate, in the layouts that LeRobot and robomimic read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import robotraj as rt
from tests.applications.studies.problems import OPTIONS, make

pytest.importorskip("pyarrow")

RATE = 20
DURATIONS = 1.0, 1.25, 1.52


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> rt.Study:
    """Three motions x = 3 s^2 - 2 s^3, and a case without one."""
    rows = [{"T": T, "bound": 100.0} for T in DURATIONS] + [{"T": 1.0, "bound": 1.0}]
    return rt.sweep(make, rows, store=tmp_path_factory.mktemp("data") / "store", **OPTIONS)


def exact(T: float, t: np.ndarray) -> np.ndarray:
    s = t / T
    return np.column_stack([3 * s**2 - 2 * s**3, 6 * (s - s**2) / T])


@pytest.fixture(scope="module")
def folder(study: rt.Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return study.to_lerobot(tmp_path_factory.mktemp("lerobot") / "set", RATE, task="slide", robot_type="block")


def test_the_frames_of_a_lerobot_set_are_the_motions_at_its_rate(study: rt.Study, folder: Path) -> None:
    import pyarrow.parquet as parquet

    info = json.loads((folder / "meta/info.json").read_text())
    frames = parquet.read_table(folder / info["data_path"].format(chunk_index=0, file_index=0)).to_pydict()
    episodes = parquet.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert info["codebase_version"] == "v3.0" and info["total_episodes"] == len(episodes) == len(DURATIONS)
    assert info["total_frames"] == len(frames["index"]) == episodes[-1]["dataset_to_index"]
    assert frames["index"] == list(range(info["total_frames"]))
    lengths = sorted(int(T * RATE + 1e-9) + 1 for T in DURATIONS)
    assert sorted(row["length"] for row in episodes) == lengths
    known = {row["key"]: row["case_T"] for row in study.table.to_pylist() if row["success"]}
    order = [T for key, T in known.items()]
    for row, T in zip(episodes, order, strict=True):
        own = slice(row["dataset_from_index"], row["dataset_to_index"])
        times = np.array(frames["timestamp"][own])
        assert np.allclose(times, np.arange(row["length"]) / RATE) and set(frames["episode_index"][own]) == {
            row["episode_index"]
        }
        assert np.allclose(np.array(frames["observation.state"][own]), exact(T, times), atol=5e-4)
        assert np.allclose(frames["action"][own], (6 - 12 * times / T) / T**2, atol=1e-3)


def test_the_statistics_of_a_lerobot_set_are_those_of_all_frames(folder: Path) -> None:
    import pyarrow.parquet as parquet

    found = json.loads((folder / "meta/stats.json").read_text())
    frames = parquet.read_table(folder / "data/chunk-000/file-000.parquet").to_pydict()
    states = np.array(frames["observation.state"], float)
    own = found["observation.state"]
    assert own["count"] == [len(states)]
    for name, value in (
        ("min", states.min(0)),
        ("max", states.max(0)),
        ("mean", states.mean(0)),
        ("std", states.std(0)),
    ):
        assert np.allclose(own[name], value, atol=1e-6), name


def test_lerobot_loads_its_set(folder: Path) -> None:
    """It reads frames of a window of time, pads the last one, and finds the task."""
    module = pytest.importorskip("lerobot.datasets.lerobot_dataset")
    data = module.LeRobotDataset("local/slide", root=folder, delta_timestamps={"action": [0.0, 1.0 / RATE]})
    assert data.num_episodes == len(DURATIONS) and data.fps == RATE
    last = data[len(data) - 1]
    assert last["task"] == "slide" and last["action_is_pad"].tolist() == [False, True]


@pytest.fixture(scope="module")
def file(study: rt.Study, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("h5py")
    return study.to_robomimic(tmp_path_factory.mktemp("robomimic") / "set.hdf5", RATE, held_out=0.34, scale=6.0)


def test_a_file_of_robomimic_has_steps_with_their_next_observation(study: rt.Study, file: Path) -> None:
    import h5py

    with h5py.File(file) as read:
        demos = [read["data"][f"demo_{i}"] for i in range(len(DURATIONS))]
        masks = {part: {name.decode() for name in read["mask"][part][:]} for part in ("train", "valid")}
        assert len(masks["valid"]) == 1 and masks["train"] | masks["valid"] == {f"demo_{i}" for i in range(3)}
        assert read["data"].attrs["total"] == sum(demo.attrs["num_samples"] for demo in demos)
        assert "env_name" in json.loads(read["data"].attrs["env_args"])
        for demo in demos:
            T = json.loads(demo.attrs["case"])["T"]
            states, following = demo["obs/state"][:], demo["next_obs/state"][:]
            times = np.arange(len(states)) / RATE
            assert np.array_equal(states[1:], following[:-1]) and len(states) == demo.attrs["num_samples"]
            assert np.allclose(states, exact(T, times), atol=5e-4)
            assert np.allclose(demo["actions"][:, 0], (1 - 2 * times / T) / T**2, atol=1e-3)
            assert demo["dones"][:].tolist() == [0] * (len(states) - 1) + [1]


def test_robomimic_loads_its_file(file: Path) -> None:
    data = pytest.importorskip("robomimic.utils.dataset")
    pytest.importorskip("robomimic.utils.obs_utils").initialize_obs_utils_with_obs_specs(
        {"obs": {"low_dim": ["state"], "rgb": []}}
    )
    known = data.SequenceDataset(str(file), ["state"], ["actions", "dones"], seq_length=4, filter_by_attribute="train")
    assert known.n_demos == 2 and known[0]["actions"].shape == (4, 1) and known[0]["next_obs"]["state"].shape == (4, 2)


def test_positions_as_actions_are_those_of_the_next_frame(study: rt.Study, tmp_path: Path) -> None:
    import pyarrow.parquet as parquet

    folder = study.to_lerobot(tmp_path / "positions", 10, action="q")
    frames = parquet.read_table(folder / "data/chunk-000/file-000.parquet").to_pydict()
    states, actions = np.array(frames["observation.state"]), np.array(frames["action"])
    inner = np.diff(frames["episode_index"]) == 0
    assert np.array_equal(actions[:-1][inner], states[1:][inner])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": 0}, "above 0"),
        ({"rate": 2.5}, "whole frames"),
        ({"action": "v"}, "'tau'"),
        ({"rate": 0.9}, "whole frames"),
    ],
)
def test_wrong_options_are_named(study: rt.Study, tmp_path: Path, options: dict[str, object], message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        study.to_lerobot(tmp_path / "set", **options)  # type: ignore[arg-type]


def test_a_folder_with_files_is_kept(study: rt.Study, tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("")
    with pytest.raises(rt.InputError, match="not empty"):
        study.to_lerobot(tmp_path)


def test_a_rate_below_one_sample_a_motion_is_named(study: rt.Study, tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    with pytest.raises(rt.InputError, match="give more"):
        study.to_robomimic(tmp_path / "set.hdf5", 0.5)


def test_scales_of_actions_are_one_for_each(study: rt.Study, tmp_path: Path) -> None:
    pytest.importorskip("h5py")
    with pytest.raises(rt.InputError, match="1 of them"):
        study.to_robomimic(tmp_path / "set.hdf5", scale=[1.0, 2.0])
    assert not (tmp_path / "set.hdf5").exists()


@pytest.mark.parametrize("reader", ["pandas", "polars", "duckdb"])
def test_other_readers_open_the_rows(study: rt.Study, reader: str) -> None:
    module = pytest.importorskip(reader)
    files = str(study.store.folder / "rows")
    if reader == "duckdb":
        found = module.sql(f"select count(*), sum(case_T) from '{files}/*.parquet' where success").fetchall()[0]
    else:
        table = module.read_parquet(files if reader == "pandas" else f"{files}/*.parquet")
        solved = table[table["success"]] if reader == "pandas" else table.filter(table["success"])
        found = len(solved), solved["case_T"].sum()
    assert found[0] == len(DURATIONS) and found[1] == pytest.approx(sum(DURATIONS))
