"""The process that compiles in the background: ``python -m robotraj.native.engines JOB COMPILER PROCESSES``."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import casadi as ca

from robotraj.native.engines.cache import Cache
from robotraj.native.engines.compiled import build
from robotraj.native.engines.compiler import find_compiler

if __name__ == "__main__":
    job, command, processes = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    os.nice(10)  # plans that run meanwhile take precedence
    cache = Cache(job.parent)
    functions = {path.stem: ca.Function.load(str(path)) for path in sorted(job.glob("*.casadi"))}
    shutil.rmtree(job)
    build(functions, cache, find_compiler(command), processes)
