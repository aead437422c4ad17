"""A study as a LeRobot data set without images: the folders, Parquet files and tables of its layout 3.0.

Source: the layout that LeRobot documents as "LeRobotDataset v3.0".
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robotraj._util.errors import InputError
from robotraj._util.system.whole_files import WholeFile, refusals_named
from robotraj.applications.studies.data_sets.episodes import Episode, episodes
from robotraj.applications.studies.rows import arrow
from robotraj.applications.studies.store import Store

if TYPE_CHECKING:
    import pyarrow as pa


LAYOUT = "v3.0"
FILES, MEGABYTES = 1000, 100
"""Files a folder, and the size of a file from which the next one begins."""
PLACE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
STATE, ACTION = "observation.state", "action"

Columns = Mapping[str, NDArray[Any]]


def write_lerobot(
    store: Store, folder: str | Path, *, rate: int, action: str, task: str, robot_type: str | None
) -> Path:
    """Write a folder that LeRobot reads; see ``Study.to_lerobot``."""
    arrow()
    root = Path(folder)
    if not isinstance(rate, int) or isinstance(rate, bool):
        raise InputError(f"rate= is {rate!r}; LeRobot counts whole frames a second, such as 50.")
    with refusals_named(root):
        root.parent.mkdir(parents=True, exist_ok=True)
        taken = root.exists() and (not root.is_dir() or any(root.iterdir()))
    if taken:
        raise InputError(
            f"{str(folder)!r} exists and is not empty: a data set is written as a whole, into a new folder."
        )
    with WholeFile(root, folder=True) as partial:
        partial.mkdir()
        _write_set(store, partial, rate, action, task, robot_type)
    return root


def _write_set(store: Store, root: Path, rate: int, action: str, task: str, robot_type: str | None) -> None:
    every: list[dict[str, Any]] = []
    waiting: list[Columns] = []
    frames, size, file = 0, 0, 0
    for number, episode in enumerate(episodes(store, rate, action)):
        columns = _columns(episode, number, frames, rate)
        count = len(episode.state)
        every.append(_entry(number, frames, count, file, task) | _flat(_statistics(columns)))
        waiting.append(columns)
        frames, size = frames + count, size + episode.state.nbytes + episode.action.nbytes
        if size > 1e6 * MEGABYTES:
            _write(_frames(waiting), root / "data" / _place(file))
            waiting, size, file = [], 0, file + 1
    if waiting:
        _write(_frames(waiting), root / "data" / _place(file))
    meta = root / "meta"
    _write(arrow().Table.from_pylist(every), meta / "episodes" / _place(0))
    _write(_tasks(task), meta / "tasks.parquet")
    shapes = {name: every[0][f"stats/{name}/min"] for name in (STATE, ACTION)}
    _write_json(_info(shapes, len(every), frames, rate, robot_type), meta / "info.json")
    _write_json(_joined(every), meta / "stats.json")


def _columns(episode: Episode, number: int, first: int, rate: int) -> Columns:
    """Return the columns of the frames of one episode."""
    count = len(episode.state)
    frame = np.arange(count, dtype=np.int64)
    return {
        STATE: episode.state,
        ACTION: episode.action,
        "timestamp": (frame / rate).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.full(count, number, dtype=np.int64),
        "index": first + frame,
        "task_index": np.zeros(count, dtype=np.int64),
    }


def _entry(number: int, first: int, count: int, file: int, task: str) -> dict[str, Any]:
    """Return the row of an episode."""
    places = {"data/chunk_index": file // FILES, "data/file_index": file % FILES}
    places |= {"meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
    span = {"dataset_from_index": first, "dataset_to_index": first + count}
    return {"episode_index": number, "tasks": [task], "length": count, **places, **span}


def _statistics(columns: Columns) -> dict[str, dict[str, list[float]]]:
    """Return least, greatest, mean, standard deviation, count and quantiles of every column."""
    found = {}
    for name, values in columns.items():
        rows = np.asarray(values, float).reshape(len(values), -1)
        own = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0)}
        own |= {key: np.quantile(rows, share, axis=0) for key, share in QUANTILES.items()}
        found[name] = {key: value.tolist() for key, value in own.items()} | {"count": [len(rows)]}
    return found


def _joined(every: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, list[float]]]:
    """Return the statistics of all frames from those of the episodes; quantiles are means over the frames."""
    found: dict[str, dict[str, list[float]]] = {}
    names = sorted({key.split("/")[1] for key in every[0] if key.startswith("stats/")})
    for name in names:
        own = {key: np.array([row[f"stats/{name}/{key}"] for row in every]) for key in ("min", "max", "mean", "std")}
        count = np.array([row[f"stats/{name}/count"] for row in every], float)
        mean = np.sum(count * own["mean"], 0) / count.sum()
        square = np.sum(count * (own["std"] ** 2 + (own["mean"] - mean) ** 2), 0) / count.sum()
        whole = {"min": own["min"].min(0), "max": own["max"].max(0), "mean": mean, "std": np.sqrt(square)}
        for key in QUANTILES:
            whole[key] = np.sum(count * np.array([row[f"stats/{name}/{key}"] for row in every]), 0) / count.sum()
        found[name] = {key: value.tolist() for key, value in whole.items()} | {"count": [int(count.sum())]}
    return found


def _flat(statistics: Mapping[str, Mapping[str, list[float]]]) -> dict[str, list[float]]:
    return {f"stats/{name}/{key}": value for name, own in statistics.items() for key, value in own.items()}


def _info(
    shapes: Mapping[str, Sequence[float]], count: int, frames: int, rate: int, robot_type: str | None
) -> dict[str, Any]:
    """Return the description of the data set."""
    letters = {STATE: "x", ACTION: "u"}
    features: dict[str, Any] = {
        name: {"dtype": "float32", "shape": [len(one)], "names": [f"{letters[name]}{i}" for i in range(len(one))]}
        for name, one in shapes.items()
    }
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    for name in ("frame_index", "episode_index", "index", "task_index"):
        features[name] = {"dtype": "int64", "shape": [1], "names": None}
    return {
        "codebase_version": LAYOUT,
        "robot_type": robot_type,
        "total_episodes": count,
        "total_frames": frames,
        "total_tasks": 1,
        "chunks_size": FILES,
        "data_files_size_in_mb": MEGABYTES,
        "video_files_size_in_mb": 2 * MEGABYTES,
        "fps": rate,
        "splits": {"train": f"0:{count}"},
        "data_path": f"data/{PLACE}",
        "video_path": None,
        "features": features,
    }


def _frames(waiting: Sequence[Columns]) -> pa.Table:
    """Return the frames of several episodes; vectors are lists of fixed length, and one number is a number."""
    pa = arrow()
    columns = {}
    for name in waiting[0]:
        whole = np.concatenate([each[name] for each in waiting])
        if whole.ndim == 2 and whole.shape[1] > 1:
            columns[name] = pa.FixedSizeListArray.from_arrays(pa.array(whole.ravel()), whole.shape[1])
        else:
            columns[name] = pa.array(whole.ravel())
    return pa.table(columns)


def _tasks(task: str) -> pa.Table:
    """Return the table of tasks, whose index for pandas is the text."""
    pa = arrow()
    table = pa.table({"task_index": pa.array([0], pa.int64()), "task": pa.array([task])})
    column = {"field_name": "task", "name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": None}
    number = {"field_name": "task_index", "name": "task_index", "pandas_type": "int64", "numpy_type": "int64"}
    about = {"index_columns": ["task"], "column_indexes": [], "columns": [number | {"metadata": None}, column]}
    return table.replace_schema_metadata({"pandas": json.dumps(about | {"pandas_version": "2.0"})})


def _place(file: int) -> str:
    return PLACE.format(chunk_index=file // FILES, file_index=file % FILES)


def _write(table: pa.Table, path: Path) -> None:
    import pyarrow.parquet as parquet

    path.parent.mkdir(parents=True, exist_ok=True)
    parquet.write_table(table, path)


def _write_json(value: object, path: Path) -> None:
    path.write_text(json.dumps(value, indent=4))
