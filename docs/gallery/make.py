"""Plan every example and every case with a published optimum, and make their tiles of the gallery.

``pip install -e '.[docs,test]'``, then ``python docs/gallery/make.py``; names in the arguments choose tiles. Examples
run as they are, each in a process of its own, in ``build/gallery/replays``. Cases are those of ``benchmarks/cases.py``,
planned to a tolerance of 1e-6. The numbers go to ``docs/gallery/results.json``, pictures and animations to
``docs/_static/gallery``. A tile names the commit that it was made from.

``--replays`` writes the replays of the cases and nothing else; those of the examples are written by the examples.
"""

from __future__ import annotations

import ast
import json
import os
import re
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "gallery" / "replays"
RESULTS = Path(__file__).with_name("results.json")
Tile = dict[str, Any]


def processor() -> float:
    """Return the processor seconds of this process and of those that it started."""
    return sum(os.times()[:4])


def slug(name: str) -> str:
    """Return a name as that of a file."""
    return re.sub(r"\W+", "_", name).strip("_")


def verdict(plans: list[Any], shown: list[Any], passed: list[bool]) -> str:
    """Return what holds of an example: its plans, those that its replays show, and the reports of the simulation."""
    if not all(plan.success for plan in plans):
        return "failed"
    proved = all(plan.proved for plan in shown or plans)
    return f"{'proved' if proved else 'solved'}, {'and simulated' if all(passed) else 'simulation failed'}"


def run_example(stem: str) -> Tile:
    """Run an example in this process, in the current folder, and record its plans, reports and replays."""
    import robotraj as rt

    plans: list[rt.Solution] = []
    shown: list[tuple[str, rt.Solution]] = []
    passed: list[bool] = []
    seconds: list[float] = []

    def timed(call: Any, keep: Any) -> Any:
        def run(*arguments: Any, **options: Any) -> Any:
            began = processor()
            value = call(*arguments, **options)
            seconds.append(processor() - began)
            keep(value)
            return value

        return run

    def replayed(solution: rt.Solution, path: str, **options: Any) -> Path:
        shown.append((str(path), solution))
        return replay(solution, path, **options)

    def validated(*arguments: Any, **options: Any) -> Any:
        report = validate(*arguments, **options)
        passed.append(report.passed)
        return report

    replay, validate = rt.replay, rt.validate
    names = vars(rt)
    for name in ("plan", "retime"):
        names[name] = timed(getattr(rt, name), plans.append)
    names["multistart"] = timed(rt.multistart, lambda found: plans.append(found.best))
    names["replay"], names["validate"] = replayed, validated
    example = ROOT / "examples" / f"{stem}.py"
    began = processor()
    runpy.run_path(str(example), run_name="__main__")
    whole = processor() - began
    last = shown[-1][1] if shown else (plans[-1] if plans else None)
    if not passed:  # the example simulates nothing itself
        passed = [validate(solution).passed for _, solution in shown]
    robot = bool(shown) and shown[0][1].problem.phases[0].robot is not None
    if last and not robot and not Path(f"{stem}.png").exists():
        last.plot().savefig(f"{stem}.png", dpi=100)
    return {
        "kind": "example",
        "name": stem,
        "file": stem,
        "title": (ast.get_docstring(ast.parse(example.read_text())) or "").splitlines()[0],
        "code": f"examples/{stem}.py",
        "objective": last.objective if last else None,
        "seconds": sum(seconds) or whole,  # of a replanner, the whole example
        "verdict": verdict(plans, [solution for _, solution in shown], passed),
        "replays": [path for path, _ in shown],
        "moment": 0.45 * shown[0][1].duration if robot else None,
    }


def examples(names: list[str]) -> list[Tile]:
    """Run the chosen examples, each in a process of its own."""
    tiles = []
    for path in sorted((ROOT / "examples").glob("[0-9]*.py")):
        if names and not any(name in path.stem for name in names):
            continue
        out = FOLDER / f"{path.stem}.json"
        out.unlink(missing_ok=True)
        done = subprocess.run(
            [sys.executable, __file__, "--run", path.stem], cwd=FOLDER, capture_output=True, text=True
        )
        (FOLDER / f"{path.stem}.log").write_text(done.stdout + done.stderr)
        if out.exists():
            tiles.append(json.loads(out.read_text()))
        print(path.stem, tiles[-1]["verdict"] if out.exists() else f"did not finish, see {path.stem}.log", flush=True)
    return tiles


def code_of(name: str) -> str:
    """Return the file in which a case is written."""
    for table in ("tests/cases/systems.yaml", "benchmarks/problems/more.yaml"):
        if f"- id: {name}\n" in (ROOT / table).read_text():
            return table
    builder = "robots" if name.endswith("URDF") else "biped" if name.startswith("biped") else "sliding_mass"
    return f"benchmarks/problems/{builder}.py"


def cases(names: list[str]) -> list[Tile]:
    """Plan the chosen cases, draw and replay them."""
    sys.path.insert(0, str(ROOT / "benchmarks"))
    from cases import cases as every
    from problems.case import run

    import robotraj as rt

    tiles = []
    for case in every():
        file = slug(case.name)
        if names and not any(name in file for name in names):
            continue
        began = processor()
        result = run(case)
        seconds = processor() - began
        solution = result.solution
        solution.plot().savefig(FOLDER / f"{file}.png", dpi=100)
        report = rt.validate(solution)
        rt.replay(solution, FOLDER / f"{file}.html", title=case.name, report=report)
        robot = solution.problem.phases[0].robot is not None
        reached = "published value reached" if result.reached else f"missed: {solution.status.value}"
        tiles.append(
            {
                "kind": "case",
                "name": case.name,
                "file": file,
                "title": "a robot from its URDF" if robot else "equations written with CasADi",
                "code": code_of(case.name),
                "objective": solution.objective,
                "published": case.exact,
                "accuracy": case.accuracy,
                "source": case.source,
                "error": result.error,
                "seconds": seconds,
                "verdict": f"{reached}, and simulated" if report.passed else f"{reached}, simulation failed",
                "replays": [f"{file}.html"],
                "moment": 0.45 * solution.duration if robot else None,
            }
        )
        print(case.name, tiles[-1]["verdict"], flush=True)
    return tiles


def main(names: list[str]) -> None:
    """Make the chosen tiles, all by default; tiles that were not chosen stay."""
    from thumbnails import draw

    command = ["git", "rev-parse", "--short", "HEAD"]
    commit = subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stdout.strip()
    made = [tile | {"commit": commit} for tile in examples(names) + cases(names)]
    old = json.loads(RESULTS.read_text())["tiles"] if RESULTS.exists() and names else []
    tiles = {tile["file"]: tile for tile in old} | {tile["file"]: tile for tile in made}
    order = sorted(
        tiles.values(), key=lambda tile: (tile["kind"] != "example", tile["name"] * (tile["kind"] == "example"))
    )
    RESULTS.write_text(json.dumps({"written by": "python docs/gallery/make.py", "tiles": order}, indent=1) + "\n")
    draw(made, FOLDER)


if __name__ == "__main__":
    os.environ.setdefault("MPLBACKEND", "agg")
    FOLDER.mkdir(parents=True, exist_ok=True)
    if sys.argv[1:] == ["--replays"]:
        cases([])
    elif sys.argv[1:2] == ["--run"]:
        Path(f"{sys.argv[2]}.json").write_text(json.dumps(run_example(sys.argv[2])))
    else:
        main(sys.argv[1:])
