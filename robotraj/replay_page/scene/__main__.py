"""The process that reads mesh files for a page: their content comes in, coloured parts go out."""

from __future__ import annotations

import json
from pathlib import Path

from robotraj._util.system.limited import serve
from robotraj.replay_page.scene.mesh_file import Beside, parts_of
from robotraj.replay_page.scene.part import packed


def _parts(question: bytes) -> bytes:
    head, _, data = question.partition(b"\n")
    suffix, folder = json.loads(head)
    beside = Beside(Path(folder))
    parts = parts_of(data, suffix, beside)
    return packed(parts, beside.opened == 0)


if __name__ == "__main__":
    serve(_parts)
