"""One hostile argument in a public call ends in a result, or in an error that this project words."""

from __future__ import annotations

import os

import pytest
from calls import Calls, fault

COUNT = int(os.environ.get("FUZZ_CALLS", "500"))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_hostile_arguments_are_refused_in_plain_words(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    calls = Calls()
    assert len(calls.called) > 300
    assert [found for number in range(COUNT) if (found := fault(number, calls))] == []
