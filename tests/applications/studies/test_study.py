"""Every case of a study is planned once, whatever stops, and its folder has all that was found."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robotraj as rt
from robotraj.applications.many.failure import Failure
from robotraj.applications.studies import dispatch, work
from robotraj.applications.studies.cases import as_cases
from robotraj.applications.studies.rows import row_of
from robotraj.applications.studies.store import Store
from robotraj.solvers.status import Status
from tests.applications.studies.problems import OPTIONS, cases, make

pytest.importorskip("pyarrow")


def keys_of(folder: Path) -> list[str]:
    """Keys of all files, doubles included."""
    import pyarrow.parquet as parquet

    files = sorted((folder / "rows").glob("[0-9a-f]*.parquet"))
    return [key for path in files for key in parquet.read_table(path, columns=["key"]).column("key").to_pylist()]


@pytest.fixture(scope="module")
def six(tmp_path_factory: pytest.TempPathFactory) -> rt.Study:
    """Six cases, one of them twice, the last infeasible."""
    folder = tmp_path_factory.mktemp("six") / "store"
    rows = [{"T": 1.0 + 0.1 * i, "bound": 100.0} for i in range(5)] + [
        {"T": 1.0, "bound": 1.0},
        {"T": 1.0, "bound": 100.0},
    ]
    return rt.sweep(make, rows, store=folder, keep="all", validate=True, **OPTIONS)


def test_a_row_has_the_case_the_figures_and_the_motion(six: rt.Study) -> None:
    rows = {(row["case_T"], row["case_bound"]): row for row in six.table.to_pylist()}
    assert len(rows) == len(six) == 6
    for (duration, bound), row in rows.items():
        assert row["success"] == (bound == 100.0)
        if row["success"]:
            assert row["objective"] == pytest.approx(12.0 / duration**3, rel=1e-6)
            assert row["duration"] == pytest.approx(duration) and row["validated"] and row["drift"] < 1e-3
            assert row["seconds"] > 0.0 and row["memory"] > 10.0 and row["host"] and row["version"]
            motion = six.motion(row["key"])
            s = motion["t"] / duration
            assert np.allclose(motion["q"][:, 0], 3 * s**2 - 2 * s**3, atol=1e-5)
            assert motion["tau"].shape == (64, 1)
    assert six.failures.column("status").to_pylist() == [Status.INFEASIBLE.value]
    assert six.missing == [] and "6 plans" in str(six) and "infeasible: 1" in str(six)


def test_whole_solutions_are_kept_where_they_are_asked_for(six: rt.Study) -> None:
    row = next(row for row in six.figures.to_pylist() if row["success"])
    phase = make({"T": row["case_T"], "bound": row["case_bound"]})
    assert six.solution(row["key"], phase).objective == pytest.approx(row["objective"], rel=1e-12)
    figure = six.plot("T")
    assert len(figure.axes[0].lines[0].get_xdata()) == 5
    with pytest.raises(rt.UnknownName, match="column of the study"):
        six.plot("speed")
    with pytest.raises(rt.UnknownName, match="with the key"):
        six.motion("none")


def test_the_same_call_plans_nothing_again_and_another_option_everything(tmp_path: Path) -> None:
    first = rt.sweep(make, cases(4), store=tmp_path, **OPTIONS)
    assert len(first) == 4
    again = rt.sweep(make, cases(6), store=tmp_path, **OPTIONS)
    assert len(again) == len(keys_of(tmp_path)) == 6
    other = rt.sweep(make, cases(2), store=tmp_path, mesh=rt.Mesh(5))
    assert len(other) == 8
    with pytest.raises(rt.InputError, match='keep="all"'):
        other.solution(keys_of(tmp_path)[0])


@pytest.mark.parametrize("kind", ["dicts", "array", "arrow"])
def test_cases_are_tables_of_any_kind(kind: str, tmp_path: Path) -> None:
    import pyarrow as pa

    given: Any = {
        "dicts": [{"a": 1, "b": "x"}, {"b": "y", "a": 2.5}],
        "array": np.array([[1.0, 2.0], [3.0, 4.0]]),
        "arrow": pa.table({"a": [1.0, 2.0], "b": [True, False]}),
    }[kind]
    found = as_cases(given, "digest")
    assert len(found.by_key) == 2 and len(found.names) == 2


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], "at least one case"),
        ([{"a": 1}, {"b": 2}], r"Case 1 has the columns \['b'\]"),
        ([{"a": np.nan}], "finite number"),
        ([{"a": [1, 2]}], "finite number"),
        ([3], "Case 0 is 3"),
        (np.zeros(3), r"shape \(3,\)"),
    ],
)
def test_wrong_cases_are_named(given: object, message: str) -> None:
    with pytest.raises(rt.InputError, match=message):
        as_cases(given, "digest")


def test_wrong_calls_are_named(tmp_path: Path) -> None:
    with pytest.raises(rt.InputError, match="a function, its cases and a folder"):
        rt.sweep(make, cases(2))  # type: ignore[call-overload]
    with pytest.raises(rt.InputError, match="keep= is 'some'"):
        rt.sweep(make, cases(2), store=tmp_path, keep="some")
    with pytest.raises(rt.InputError, match="part 3 of 3 is none"):
        rt.sweep(make, cases(2), store=tmp_path, part=(3, 3))
    with pytest.raises(rt.InputError, match="is no study"):
        rt.Study(tmp_path / "nothing")


def test_one_part_takes_what_the_others_leave_and_nothing_twice(tmp_path: Path) -> None:
    here = [(1, 3), (0, 3), (2, 3)]
    counts = []
    for part in here:
        rt.sweep(make, cases(7), store=tmp_path, part=part, **OPTIONS)
        counts.append(len(keys_of(tmp_path)))
    assert counts == [7, 7, 7] and len(set(keys_of(tmp_path))) == 7


def test_a_case_that_raises_or_ends_its_process_is_a_row(tmp_path: Path) -> None:
    def faulty(case: Any) -> rt.Phase:
        if case["T"] == 1.1:
            raise LookupError("no such thing")
        if case["T"] == 1.2:
            os._exit(7)
        return make(case)

    study = rt.sweep(faulty, cases(5), store=tmp_path, **OPTIONS)
    rows = {round(row["case_T"], 1): row for row in study.table.to_pylist()}
    assert [rows[t]["success"] for t in (1.0, 1.1, 1.2, 1.3, 1.4)] == [True, False, False, True, True]
    assert "error: 1, the first one: FailedExpression: make(case) failed: LookupError: no such thing" in str(study)
    assert "LookupError" in rows[1.1]["message"] and rows[1.2]["status"] == Status.DIED.value
    with pytest.raises(rt.InputError, match="has no motion"):
        study.motion(rows[1.1]["key"])


class Losing(Executor):
    """Runs chunks in this process and loses the second one."""

    def __init__(self) -> None:
        self.count = 0

    def submit(self, function: Any, /, *given: Any, **named: Any) -> Future[Any]:
        self.count += 1
        future: Future[Any] = Future()
        if self.count == 2:
            future.set_exception(ConnectionError("the scheduler is gone"))
        else:
            future.set_result(function(*given, **named))
        return future


@pytest.mark.parametrize(
    "executor",
    [
        lambda: ThreadPoolExecutor(1),
        pytest.param(lambda: ProcessPoolExecutor(1, get_context("spawn")), marks=pytest.mark.slow),
    ],
)
def test_any_executor_plans_chunks(executor: Any, tmp_path: Path) -> None:
    with executor() as pool:
        study = rt.sweep(make, cases(5), store=tmp_path, executor=pool, **OPTIONS)
    assert study.missing == [] and sorted(keys_of(tmp_path)) == sorted(set(keys_of(tmp_path)))
    assert all(study.table.column("success").to_pylist())


def test_a_chunk_that_is_lost_is_planned_by_the_next_start(tmp_path: Path) -> None:
    with pytest.warns(UserWarning, match="chunks of the study were lost .*the scheduler is gone"):
        study = rt.sweep(make, cases(4), store=tmp_path, executor=Losing(), **OPTIONS)
    assert 0 < len(study.missing) < 4
    again = rt.sweep(make, cases(4), store=tmp_path, executor=ThreadPoolExecutor(1), **OPTIONS)
    assert again.missing == [] and len(keys_of(tmp_path)) == 4


def test_a_full_disk_is_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    refused, add = [], Store.add

    def full(store: Store, *given: Any) -> None:
        if len(refused) < 2:
            refused.append(1)
            raise rt.InputError("could not be written: No space left on device")
        add(store, *given)

    monkeypatch.setattr(work, "PAUSE", 0.01)
    monkeypatch.setattr(Store, "add", full)
    assert rt.sweep(make, cases(3), store=tmp_path, **OPTIONS).missing == [] and len(refused) == 2
    refused.clear()
    monkeypatch.setattr(work, "ATTEMPTS", 2)
    with pytest.raises(rt.InputError, match="No space left"):
        rt.sweep(make, cases(5), store=tmp_path, **OPTIONS)
    assert len(keys_of(tmp_path)) == 3


SCRIPT = """
import sys
sys.path.insert(0, sys.argv[2])
import robotraj as rt
from robotraj.applications.studies import dispatch
from tests.applications.studies.problems import OPTIONS, cases, make
dispatch.CHUNK = 0.2
rt.sweep(make, cases(60), store=sys.argv[1], **OPTIONS)
"""


@pytest.mark.slow
@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGINT])
def test_a_client_that_is_stopped_goes_on_where_it_was(stop: int, tmp_path: Path) -> None:
    root = str(Path(__file__).parents[3])
    with subprocess.Popen([sys.executable, "-c", SCRIPT, str(tmp_path), root], stderr=subprocess.DEVNULL) as client:
        until = time.monotonic() + 100.0
        while time.monotonic() < until and not len(keys_of(tmp_path)) > 3:
            time.sleep(0.05)
        client.send_signal(stop)
        client.wait(60.0)
    before = keys_of(tmp_path)
    assert len(before) > 3
    study = rt.sweep(make, cases(60), store=tmp_path, **OPTIONS)
    after = keys_of(tmp_path)
    assert study.missing == [] and len(after) == len(set(after)) == 60 and set(before) <= set(after)
    assert sorted(before) == sorted(set(before))


def test_ctrl_c_writes_what_was_planned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    count, finished = [], dispatch._finished

    def pressed(*given: Any) -> Any:
        count.append(1)
        if len(count) == 3:
            raise KeyboardInterrupt
        return finished(*given)

    monkeypatch.setattr(dispatch, "_finished", pressed)
    with pytest.raises(KeyboardInterrupt):
        rt.sweep(make, cases(40), store=tmp_path, **OPTIONS)
    assert len(keys_of(tmp_path)) >= 2


@pytest.mark.slow
def test_twenty_thousand_rows_are_opened_and_asked_within_a_second(tmp_path: Path) -> None:
    every = as_cases([{"T": float(i)} for i in range(20_000)], "digest")
    store = Store(tmp_path, create=True)
    store.begin(every, {})
    items = list(every.by_key.items())
    motion = {name: np.zeros(64 * 7, np.float32) for name in ("q", "v", "tau")}
    for first in range(0, 20_000, 500):
        rows = [
            row_of(Failure(0, Status.DIED, "ended"), key, case, 0.1) | motion
            for key, case in items[first : first + 500]
        ]
        store.add(rows, every)
    began = time.process_time()
    study = rt.Study(tmp_path)
    table = study.figures
    slow = sum(seconds > 0.05 for seconds in table.column("seconds").to_pylist())
    assert time.process_time() - began < 1.0
    assert table.num_rows == slow == 20_000


@pytest.mark.slow
def test_a_study_with_a_crash_a_hang_and_a_hog_has_the_other_results_and_three_rows(tmp_path: Path) -> None:
    def faulty(case: Any) -> rt.Phase:
        if case["number"] == 7:
            os.kill(os.getpid(), signal.SIGSEGV)
        if case["number"] == 20:
            time.sleep(600.0)
        if case["number"] == 40:
            assert [bytearray(100_000_000) for _ in range(20)]
        return make(case)

    rows = [{"T": 1.0 + 0.01 * i, "number": i} for i in range(60)]
    study = rt.sweep(faulty, rows, store=tmp_path, time_limit=2.0, memory_limit=600.0, **OPTIONS)
    failed = {int(row["case_number"]): row["status"] for row in study.failures.to_pylist()}
    assert failed == {7: Status.DIED.value, 20: Status.TIME_LIMIT.value, 40: Status.MEMORY_LIMIT.value}
    assert sum(study.table.column("success").to_pylist()) == 57


ARM = rt.load("two_link_arm")


def reach(case: Any) -> rt.Phase:
    ends = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[case["shoulder"], case["elbow"]], v=0)
    return rt.Phase(ARM, 6.0, *ends, rt.Effort())


REACHES = [{"shoulder": s, "elbow": e} for s in (1.0, 1.2) for e in (0.4, 0.6)]


def test_a_study_is_a_library_also_after_it_is_opened_again(tmp_path: Path) -> None:
    """Its plans start at the nearest motion, read from its file, and share the mesh of the first."""
    rt.sweep(reach, REACHES, store=tmp_path / "store", keep="all", executor=ThreadPoolExecutor(1))
    with pytest.raises(rt.InputError, match="keeps no function"):
        rt.Study(tmp_path / "store").library()
    library = rt.Study(tmp_path / "store").library(reach)
    case = {"shoulder": 1.05, "elbow": 0.5}
    first, found = library.plan({"shoulder": 1.1, "elbow": 0.45}), library.plan(case)
    assert first.proved and found.proved and found.phases[0].mesh == first.phases[0].mesh
    assert found.objective == pytest.approx(rt.plan(reach(case)).objective, rel=1e-3)
    assert library.answer(case).fresh


def test_a_library_needs_whole_solutions(six: rt.Study, tmp_path: Path) -> None:
    kept = rt.sweep(make, cases(2), store=tmp_path / "store", **OPTIONS)
    with pytest.raises(rt.InputError, match='keep="all"'):
        kept.library()
    assert len(six.library().solutions) == 5


def test_a_chained_study_plans_from_what_its_process_has_solved(tmp_path: Path) -> None:
    """The plans are as good, and take fewer iterations; they are other plans, so their keys differ."""
    here = ThreadPoolExecutor(1)
    cold = rt.sweep(reach, REACHES, store=tmp_path / "cold", executor=here)
    warm = rt.sweep(reach, REACHES, store=tmp_path / "warm", executor=here, chain=True)
    one, other = (study.figures.to_pylist() for study in (cold, warm))
    objectives = [
        {(row["case_shoulder"], row["case_elbow"]): row["objective"] for row in rows} for rows in (one, other)
    ]
    for case, value in objectives[0].items():
        assert objectives[1][case] == pytest.approx(value, rel=1e-3)
    assert all(row["proved"] for row in other)
    assert sum(row["iterations"] for row in other) < 0.8 * sum(row["iterations"] for row in one)
    assert not {row["key"] for row in one} & {row["key"] for row in other}


@pytest.mark.parametrize("shares", [4, 64])
def test_chunks_are_shares_of_the_cases_that_are_left(shares: int) -> None:
    """No chunk is larger than its share, every case is in one, and none is empty."""
    from robotraj.applications.studies.progress import Progress

    count = 500
    shown = Progress(count, show=False)
    shown.add(10, 0, 0.1, "first")  # 10 ms each: 20 s of work are 2000 cases
    every = [(str(i), {"T": 1.0 + i}) for i in range(count)]
    sizes = [len(chunk) for chunk in dispatch._chunks(iter(every), shown, shares)]
    left = count
    for size in sizes:
        assert 1 <= size <= max(1, int(np.ceil(left / shares)))
        left -= size
    assert left == 0 and sizes[0] == int(np.ceil(count / shares))


def test_the_whole_solutions_of_a_study_are_simulated(six: rt.Study, tmp_path: Path) -> None:
    """Each solved case passes; one whose file has another problem is named."""
    found = six.validate(ThreadPoolExecutor(1)).to_pylist()
    solved = {row["key"] for row in six.table.to_pylist() if row["success"]}
    assert {row["key"] for row in found} == solved and all(row["passed"] and row["drift"] < 1e-3 for row in found)
    with pytest.raises(rt.InputError, match='keep="all"'):
        rt.sweep(make, cases(1), store=tmp_path / "store", **OPTIONS).validate()
    lied = rt.Study(six.store.folder, lambda case: make({**case, "T": case["T"] + 1.0})).validate(ThreadPoolExecutor(1))
    assert not any(lied.column("passed").to_pylist())


def test_figures_read_each_file_once_and_later_ones_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from robotraj.applications.studies import store

    rt.sweep(make, cases(3), store=tmp_path / "s", **OPTIONS)
    study, read = rt.Study(tmp_path / "s"), []
    true = store.read_parquet
    monkeypatch.setattr(store, "read_parquet", lambda path, *a, **k: (read.append(path.name), true(path, *a, **k))[1])
    assert len(study) == study.figures.num_rows == 3 and study.failures.num_rows == 0
    before = set(read)
    assert len(read) == len(before)
    rt.sweep(make, cases(5), store=tmp_path / "s", **OPTIONS)
    read.clear()
    assert len(study) == 5 and not study.missing
    assert not before & set(read)
