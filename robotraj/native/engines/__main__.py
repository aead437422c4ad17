"""The process that compiles in the background: arguments CACHE COMPILER PROCESSES, functions on its standard input."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import casadi as ca

from robotraj.native.engines.cache import Cache
from robotraj.native.engines.compiled import build
from robotraj.native.engines.compiler import find_compiler

if __name__ == "__main__":
    os.nice(10)  # plans that run meanwhile take precedence
    folder, compiler, processes = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    functions = {key: ca.Function.deserialize(text) for key, text in json.load(sys.stdin.buffer).items()}
    build(functions, Cache(folder), find_compiler(compiler), processes)
