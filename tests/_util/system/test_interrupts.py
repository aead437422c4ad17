"""Ctrl-C waits for the end of an import, and is not lost where a library catches every error."""

from __future__ import annotations

import signal
from importlib import import_module
from pathlib import Path

import pytest

from robotraj._util.system.interrupts import heeded, undisturbed

PRESSED = """
import signal
try:
    signal.raise_signal(signal.SIGINT)
except BaseException:
    part = None
else:
    part = "whole"
"""


def test_a_press_waits_until_the_block_ends() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), undisturbed():
        signal.raise_signal(signal.SIGINT)
        done.append("block")
    assert done and signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_press_during_an_import_of_a_call_is_heeded_after_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "pressed_in_a_call.py").write_text(PRESSED)
    monkeypatch.syspath_prepend(tmp_path)
    parts = []

    @heeded
    def call() -> None:
        parts.append(import_module("pressed_in_a_call").part)

    with pytest.raises(KeyboardInterrupt):
        call()
    assert parts == ["whole"]


def test_a_press_during_the_import_of_a_public_name_leaves_the_name_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "pressed_by_name"
    package.mkdir()
    stub = "from robotraj._util.public_names import attach_stub\n"
    (package / "__init__.py").write_text(stub + "__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)\n")
    (package / "__init__.pyi").write_text('from .inner import part\n\n__all__ = ["part"]\n')
    (package / "inner.py").write_text(PRESSED)
    monkeypatch.syspath_prepend(tmp_path)
    lazy = import_module("pressed_by_name")
    with pytest.raises(KeyboardInterrupt):
        _ = lazy.part
    assert lazy.part == "whole"
