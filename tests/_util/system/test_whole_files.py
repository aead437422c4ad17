"""Files are written whole, at whatever instant Ctrl-C is pressed."""

from __future__ import annotations

import enum
import signal
import sys
from pathlib import Path
from types import FrameType

import pytest

from robotraj._util.errors import InputError
from robotraj._util.system.whole_files import WholeFile


def _write(target: Path, text: str) -> None:
    with WholeFile(target) as partial:
        partial.write_text(text)


def _pressed_at(number: int, target: Path) -> tuple[bool, bool]:
    """Write with Ctrl-C at the traced line of that number; return whether it was reached, and heeded."""
    lines = 0

    def trace(frame: FrameType, event: str, argument: object) -> object:
        nonlocal lines
        # Python takes signals where functions begin, not between a block and the call that leaves it. An error of a
        # trace in the handler of another, as in enum, would stay the one that is handled.
        if event == "line" and frame.f_code is not _write.__code__ and frame.f_code.co_filename != enum.__file__:
            lines += 1
            if lines == number:
                signal.raise_signal(signal.SIGINT)
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        _write(target, "new")
    except KeyboardInterrupt:
        return True, True
    finally:
        sys.settrace(before)
    return lines >= number, False


def test_ctrl_c_at_any_line_leaves_the_old_file_or_the_new_one(tmp_path: Path) -> None:
    target, number, reached = tmp_path / "plan.txt", 0, True
    while reached:
        number += 1
        target.write_text("old")
        reached, heeded = _pressed_at(number, target)
        assert heeded or not reached
        assert target.read_text() in ("old", "new")
        assert [path.name for path in tmp_path.iterdir()] == ["plan.txt"]
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        assert sys.exc_info() == (None, None, None)
    assert number > 50


def test_a_handler_of_the_user_is_called_and_kept(tmp_path: Path) -> None:
    pressed: list[int] = []

    def handler(number: int, frame: FrameType | None) -> None:
        pressed.append(number)

    before = signal.signal(signal.SIGINT, handler)
    try:
        with WholeFile(tmp_path / "plan.txt") as partial:
            signal.raise_signal(signal.SIGINT)
            partial.write_text("new")
        assert signal.getsignal(signal.SIGINT) is handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert pressed == [signal.SIGINT]
    assert (tmp_path / "plan.txt").read_text() == "new"


def test_an_error_of_the_block_leaves_the_old_file(tmp_path: Path) -> None:
    target = tmp_path / "plan.txt"
    target.write_text("old")
    with pytest.raises(ZeroDivisionError), WholeFile(target) as partial:
        partial.write_text(str(1 / 0))
    with pytest.raises(InputError, match="could not be written"), WholeFile(target):
        raise OSError(28, "No space left on device")
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["plan.txt"]
