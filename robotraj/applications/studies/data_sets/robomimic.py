"""A study as the HDF5 file of robomimic: one group an episode, with observations, actions and masks.

Source: the layout that robomimic documents under "Dataset structure".
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from robotraj._util.errors import InputError
from robotraj._util.system.whole_files import WholeFile
from robotraj.applications.studies.data_sets.episodes import episodes
from robotraj.applications.studies.store import Store

OBSERVED = "state"
"""Name of the observation: q and v."""
GYM = 2
"""Number of robomimic for environments that are none of its own simulators."""


def write_robomimic(
    store: Store, path: str | Path, *, rate: float, action: str, name: str, held_out: float, scale: ArrayLike | None
) -> Path:
    """Write a file that robomimic reads; see ``Study.to_robomimic``."""
    try:
        import h5py
    except ImportError as error:
        raise InputError("robomimic's files need h5py: pip install 'robotraj[learning]'.") from error
    if not 0.0 <= held_out < 1.0:
        raise InputError(f"held_out= is {held_out!r}; give the share of episodes for validation, from 0 to below 1.")
    target = Path(path)
    lengths: list[int] = []
    # HDF5 ends the process where a disk is full, so the file is made in memory.
    with h5py.File(target.name, "w", driver="core", backing_store=False) as file:
        data = file.create_group("data")
        for number, episode in enumerate(episodes(store, rate, action)):
            count = len(episode.state) - 1
            own = data.create_group(f"demo_{number}")
            own.attrs["num_samples"], own.attrs["key"] = count, episode.key
            own.attrs["case"] = json.dumps(dict(episode.case))
            own["actions"] = _scaled(episode.action, scale)[:count]
            own["states"] = episode.state[:count]
            own[f"obs/{OBSERVED}"], own[f"next_obs/{OBSERVED}"] = episode.state[:count], episode.state[1:]
            ended = np.zeros(count)
            ended[-1:] = 1.0
            own["rewards"], own["dones"] = ended, ended.astype(np.int64)
            lengths.append(count)
        data.attrs["total"] = sum(lengths)
        data.attrs["env_args"] = json.dumps({"env_name": name, "type": GYM, "env_kwargs": {}})
        order = np.random.default_rng(0).permutation(len(lengths))
        valid = round(held_out * len(lengths))
        for part, numbers in (("valid", order[:valid]), ("train", order[valid:])):
            file[f"mask/{part}"] = np.array([f"demo_{i}" for i in np.sort(numbers)], dtype="S")
        file.flush()
        content = file.id.get_file_image()
    with WholeFile(target) as partial:
        partial.write_bytes(content)
    return target


def _scaled(action: np.ndarray, scale: ArrayLike | None) -> np.ndarray:
    """Divide actions by their scales."""
    if scale is None:
        return action
    sizes = np.broadcast_to(np.asarray(scale, float), action.shape[1:]) if np.ndim(scale) == 0 else np.asarray(scale)
    if sizes.shape != action.shape[1:] or not np.all(np.isfinite(sizes) & (sizes > 0.0)):
        raise InputError(f"scale= must be one number above 0, or {action.shape[1]} of them, one for each action.")
    return np.asarray(action / sizes, dtype=np.float32)
