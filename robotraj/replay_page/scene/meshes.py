"""Mesh files as coloured parts: by content from a cache on disk, otherwise in a process under limits."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from robotraj._util.errors import InputError
from robotraj._util.paths import cache_folder
from robotraj._util.system.cached_arrays import keep
from robotraj._util.system.limited import LimitedProcess, NoAnswer
from robotraj._util.system.regular_files import contents
from robotraj.replay_page.scene.part import Part, unpacked
from robotraj.robot.meshes.reading import LARGEST, SUFFIXES

SECONDS, PER_BYTE = 4.0, 3e-7
"""Processor time for a file [s], and for each of its bytes."""
MOST_BYTES = 32 * 10**6
"""Largest size of the parts of a file, above that of as many triangles as a page shows."""
VERSION = 1
"""Version of the cached files."""

Parts = tuple[Part, ...]


def read_meshes(paths: Iterable[str]) -> dict[str, Parts | str]:
    """Return the parts of mesh files, or the reason why a file is not read."""
    found: dict[str, Parts | str] = {}
    with LimitedProcess("robotraj.replay_page.scene") as process:
        for path in dict.fromkeys(paths):
            try:
                found[path] = _read(Path(path), process)
            except (InputError, NoAnswer, ValueError) as error:
                found[path] = str(error).rstrip(".")
    return found


def _read(path: Path, process: LimitedProcess) -> Parts:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"the format {suffix or 'without a suffix'} is none of {', '.join(SUFFIXES)}")
    data = contents(path, LARGEST, "the file")
    kept = cache_folder("parts") / f"{hashlib.sha256(suffix.encode() + data).hexdigest()[:40]}-{VERSION}.npz"
    # An entry that is missing or damaged is read from the mesh again.
    with suppress(InputError, ValueError):
        return unpacked(contents(kept, MOST_BYTES))[0]
    head = json.dumps([suffix, str(path.absolute().parent)]).encode()
    answer = process.ask(head + b"\n" + data, SECONDS + PER_BYTE * len(data))
    parts, alone = unpacked(answer)
    if alone and len(answer) <= MOST_BYTES:
        keep(kept, answer)
    return parts
