"""The cache is private to its owner, consistent at every instant, and shared by processes."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.native.engines import compiler
from robotraj.native.engines.base import Mapped
from robotraj.native.engines.cache import Cache
from robotraj.native.engines.compiler import CompilationFailed

CODE = """
import casadi as ca
x, y = ca.SX.sym("x", 3), ca.SX.sym("y", 2)
polynomial = ca.Function("polynomial", [x, y], [ca.vertcat(x[0] * y[1] + x[2], ca.dot(x, x) - 2.5 * y[0])])
"""
"""The function, to be built by other processes too."""
KNOWN: dict[str, Any] = {}
exec(CODE, KNOWN)
POLYNOMIAL = KNOWN["polynomial"]
WANTED = [Mapped(POLYNOMIAL, 8)]


def use(engine: rt.engines.Compiled) -> None:
    """Prepare a function and check its value."""
    [mapped] = engine.prepare(WANTED)
    x, y = np.arange(24.0).reshape(3, 8), np.ones((2, 8))
    np.testing.assert_array_equal(np.array(mapped(x, y)), np.array(POLYNOMIAL.map(8)(x, y)))


def library(engine: rt.engines.Compiled) -> Path:
    [path] = engine.libraries(WANTED)
    return path


def test_the_folder_is_its_owners_alone(tmp_path: Path) -> None:
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o755)
    Cache(folder)
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700


def test_a_folder_that_others_may_write_is_refused(engine: rt.engines.Compiled) -> None:
    folder = Path(str(engine.cache))
    folder.mkdir()
    folder.chmod(0o770)
    with pytest.raises(rt.InputError, match=r"Others may write .*mode 770\).*XDG_CACHE_HOME"):
        engine.prepare(WANTED)


def test_a_folder_of_another_user_is_refused(engine: rt.engines.Compiled, monkeypatch: pytest.MonkeyPatch) -> None:
    use(engine)
    me = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: me + 1)
    with pytest.raises(rt.InputError, match=rf"belongs to user {me}, not to you \({me + 1}\)"):
        engine.prepare(WANTED)


@pytest.mark.parametrize("mode", [0o777, 0o757, 0o775])
def test_a_folder_above_that_others_may_write_is_refused(tmp_path: Path, mode: int) -> None:
    above = tmp_path / "above"
    Cache(above / "robotraj" / "engines")
    assert {stat.S_IMODE(each.stat().st_mode) for each in (above, above / "robotraj")} == {0o700}
    if os.getuid() == 0:
        os.chown(above, -1, 12345)
    else:  # the user's own group may be the user alone
        mode |= 0o002
    above.chmod(mode)
    with pytest.raises(rt.InputError, match=r"Others may write to .*above \(mode .*chmod go-w"):
        Cache(above / "robotraj" / "engines")
    # The sticky bit keeps every name to its owner.
    above.chmod(mode | 0o1000)
    Cache(above / "robotraj" / "engines")


def test_a_folder_above_that_belongs_to_another_user_is_refused(tmp_path: Path) -> None:
    if os.getuid() != 0:
        pytest.skip("the administrator alone can give folders away")
    Cache(tmp_path / "above" / "engines")
    os.chown(tmp_path / "above", 12345, 12345)
    with pytest.raises(rt.InputError, match="above, above the cache of compiled functions, belongs to user 12345"):
        Cache(tmp_path / "above" / "engines")
    # A link to it does not hide it.
    (tmp_path / "link").symlink_to(tmp_path / "above")
    with pytest.raises(rt.InputError, match="belongs to user 12345"):
        Cache(tmp_path / "link" / "engines")


def test_a_link_is_no_cache(engine: rt.engines.Compiled, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    Path(str(engine.cache)).symlink_to(tmp_path / "elsewhere")
    with pytest.raises(rt.InputError, match="is a link"):
        engine.prepare(WANTED)


def test_a_library_that_others_may_write_or_that_is_a_link_is_not_loaded(engine: rt.engines.Compiled) -> None:
    use(engine)
    path = library(engine)
    path.chmod(0o666)
    with pytest.raises(rt.InputError, match="Others may write"):
        engine.prepare(WANTED)
    path.chmod(0o600)
    moved = path.rename(path.with_suffix(".moved"))
    path.symlink_to(moved)
    with pytest.raises(rt.InputError, match="no regular file"):
        engine.prepare(WANTED)


def test_a_library_is_compiled_once(engine: rt.engines.Compiled) -> None:
    use(engine)
    written = library(engine).stat().st_mtime_ns
    use(engine)
    assert library(engine).stat().st_mtime_ns == written


def test_two_that_need_the_same_at_once_share_one_compilation(
    engine: rt.engines.Compiled, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored = []
    store = Cache.store
    monkeypatch.setattr(Cache, "store", lambda self, key, made: stored.append(key) or store(self, key, made))
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(use, [engine] * 4))
    assert len(stored) == 1


def test_another_process_finds_it(engine: rt.engines.Compiled) -> None:
    use(engine)
    code = (
        f"{CODE}\nimport robotraj as rt\nfrom robotraj.native.engines import Mapped\n"
        f"engine = rt.engines.Compiled(least=1, cache={str(engine.cache)!r})\n"
        "print(*engine.libraries([Mapped(polynomial, 8)]))\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == str(library(engine))


def test_a_damaged_library_is_made_again(engine: rt.engines.Compiled) -> None:
    use(engine)
    path = library(engine)
    damaged = path.with_suffix(".new")
    damaged.write_bytes(b"\x7fELF, and then the disk was full")
    os.replace(damaged, path)
    use(engine)
    assert path.stat().st_size > 1000


def test_a_truncated_library_is_found_by_its_digest_and_made_again(engine: rt.engines.Compiled) -> None:
    use(engine)
    path = library(engine)
    whole = path.stat().st_size
    with path.open("r+b") as file:
        file.truncate(whole // 2)
    assert engine.open_cache().find(path.stem) is None
    use(engine)
    assert path.stat().st_size == whole


def test_a_read_only_cache_is_used(engine: rt.engines.Compiled, monkeypatch: pytest.MonkeyPatch) -> None:
    use(engine)
    Path(str(engine.cache)).chmod(0o500)
    monkeypatch.setattr(Cache, "writable", False)
    monkeypatch.setattr(Path, "chmod", lambda *_: pytest.fail("the mode of a read-only folder cannot change"))
    use(engine)
    x = ca.SX.sym("x", 3)
    other = [Mapped(ca.Function("other", [x], [2.0 * x * x]), 8)]
    with pytest.raises(rt.InputError, match="read-only and lacks a library"):
        engine.prepare(other)


def test_folders_of_killed_compilations_are_removed(engine: rt.engines.Compiled) -> None:
    cache = engine.open_cache()
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    left, running = cache.folder / f"build-{ended.pid}-a", cache.folder / f"build-{os.getppid()}-b"
    for folder in (left, running):
        folder.mkdir()
        (folder / "library.so").write_bytes(b"half")
    use(engine)
    assert not left.exists() and running.exists()


def test_a_cleared_cache_is_empty(engine: rt.engines.Compiled) -> None:
    use(engine)
    cache = engine.open_cache()
    size = cache.size()
    assert size > 0 and cache.clear() == size
    assert list(cache.folder.iterdir()) == [] and cache.size() == 0
    use(engine)


def test_other_compilers_flags_and_processors_have_other_libraries(
    engine: rt.engines.Compiled, monkeypatch: pytest.MonkeyPatch
) -> None:
    use(engine)
    monkeypatch.setattr(compiler, "FLAGS", (*compiler.FLAGS, "-DOTHER"))
    assert not engine.libraries(WANTED)
    monkeypatch.undo()
    assert engine.libraries(WANTED)
    monkeypatch.setattr(compiler, "processor", lambda: "another")
    assert not engine.libraries(WANTED)


def test_without_a_compiler_the_way_out_is_named(
    engine: rt.engines.Compiled, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(rt.InputError, match=r"gcc or clang or cc is not .*Install gcc or clang.*rt.engines.Native\(\)"):
        engine.prepare(WANTED)
    with pytest.raises(rt.InputError, match="'nonesuch' is not on this machine"):
        rt.engines.Compiled(least=1, compiler="nonesuch", cache=engine.cache).prepare(WANTED)


def test_a_compiler_that_fails_is_quoted(engine: rt.engines.Compiled, tmp_path: Path) -> None:
    fake = tmp_path / "fake"
    fake.write_text('#!/bin/sh\n[ "$1" = -v ] && exit 0\necho "no space left" >&2\nexit 3\n')
    fake.chmod(0o755)
    broken = rt.engines.Compiled(least=1, compiler=str(fake), cache=engine.cache)
    with pytest.raises(CompilationFailed, match=r"code 3; engine=rt.engines.VirtualMachine\(\).*\nno space left"):
        broken.prepare(WANTED)
    assert not [path for path in Path(str(engine.cache)).iterdir() if path.is_dir()]


def test_after_a_failure_nothing_more_is_compiled(engine: rt.engines.Compiled, tmp_path: Path) -> None:
    fake, log = tmp_path / "fake", tmp_path / "log"
    fake.write_text(f'#!/bin/sh\n[ "$1" = -v ] && exit 0\necho x >> {log}\nsleep 0.2\nexit 3\n')
    fake.chmod(0o755)
    x = ca.SX.sym("x", 3)
    wanted = [Mapped(ca.Function(f"f{i}", [x], [i * x]), 8) for i in range(1, 30)]
    broken = rt.engines.Compiled(least=1, compiler=str(fake), cache=engine.cache, jobs=1)
    with pytest.raises(CompilationFailed):
        broken.prepare(wanted)
    assert len(log.read_text().split()) < 10  # of 58 files
    assert not [path for path in Path(str(engine.cache)).iterdir() if path.is_dir()]


def test_in_the_background_the_virtual_machine_serves_until_the_library_is_there(engine: rt.engines.Compiled) -> None:
    later = rt.engines.Compiled(wait=False, least=1, cache=engine.cache)
    use(later)
    cache = later.open_cache()
    assert not cache.libraries()
    use(later)  # finds the compilation under way
    for _ in range(600):
        if later.libraries(WANTED):
            break
        time.sleep(0.1)
    log = cache.folder / "background.log"
    assert later.libraries(WANTED), log.read_text()
    assert log.read_text() == ""
    use(later)
    assert len(list(cache.folder.glob("job-*"))) == 0


def test_senseless_values_are_refused() -> None:
    with pytest.raises(rt.InputError, match="least"):
        rt.engines.Compiled(least=-1)
    with pytest.raises(rt.InputError, match="jobs"):
        rt.engines.Compiled(jobs=0)
    with pytest.raises(rt.InputError, match="engine="):
        rt.plan(rt.Phase(rt.load("pendulum"), 1.0), engine="compiled")  # type: ignore[arg-type]


def test_a_folder_whose_name_is_no_text_is_refused_before_a_library_is_made(tmp_path: Path) -> None:
    """CasADi could not open the library; so it is with letters beyond ASCII where the locale is C."""
    with pytest.raises(rt.InputError, match="letters that are not of this locale"):
        Cache(tmp_path / os.fsdecode(b"\xff\xfe"))
