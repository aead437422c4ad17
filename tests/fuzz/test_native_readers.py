"""The compiled module answers, or raises an error of Python's, for inputs that once ended it and for random ones."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from native_readers import READERS, attempt

HERE = Path(__file__).parent
SEEDS = int(os.environ.get("FUZZ_NATIVE", "400"))
LONGEST = 300
"""Longest input [bytes]."""


def run(*arguments: str) -> None:
    """Make attempts in a process whose memory is limited."""
    done = subprocess.run(
        ["bash", "-c", 'ulimit -v 4000000; exec "$0" "$@"', sys.executable, __file__, *arguments],
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert done.returncode == 0, f"after the attempt {done.stdout[-80:]!r}: {done.stderr[-2000:]}"


def test_inputs_that_were_found_are_read_or_refused() -> None:
    run(*map(str, sorted((HERE / "corpus").iterdir())))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(READERS)), ids=lambda number: READERS[number].__name__)
def test_random_inputs_are_read_or_refused(number: int) -> None:
    run("--seeds", str(number), str(SEEDS))


def main() -> None:
    """Attempt files, or random bytes for one reader."""
    if sys.argv[1] != "--seeds":
        for name in sys.argv[1:]:
            print(name, flush=True)
            attempt(Path(name).read_bytes())
        return
    reader, count = int(sys.argv[2]), int(sys.argv[3])
    rng = np.random.default_rng([2026, reader])
    for seed in range(count):
        print(seed, flush=True)
        # Bytes from 31 on are rare draws.
        most = int(rng.choice([31, 64, 256]))
        attempt(bytes([reader]) + rng.integers(0, most, rng.integers(1, LONGEST), dtype=np.uint8).tobytes())


if __name__ == "__main__":
    main()
