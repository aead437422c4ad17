"""``robotraj show``: a robot's joints, limits and frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robotraj._util.printing import wrapped
from robotraj.cli.options import JsonOption, PackageDirsOption, RobotArgument, TrustPathsOption
from robotraj.cli.terminal import say, say_json
from robotraj.robot.limits import RATES

if TYPE_CHECKING:
    from robotraj.robot.known_robots.entry import KnownRobot
    from robotraj.robot.robot import Robot


def show(
    robot: RobotArgument,
    package_dirs: PackageDirsOption = None,
    trust_paths: TrustPathsOption = False,
    as_json: JsonOption = False,
) -> None:
    """Print a robot's joints, limits and frames."""
    from robotraj.robot.known_robots.catalogue import catalogue
    from robotraj.robot.load import load

    mover = load(robot, package_dirs=package_dirs or (), trust_paths=trust_paths)
    entry = {known.name: known for known in catalogue()}.get(robot)
    if as_json:
        say_json(_described(mover, entry))
        return
    if entry is not None:
        facts = (entry.description, f"licence: {entry.licence}", f"provenance: {entry.provenance}")
        say("\n".join(line for fact in facts for line in wrapped(fact)) + "\n")
    say(mover)
    for warning in mover.limits.warnings(mover.actuated):
        say("\n".join(wrapped(f"! {warning}")))
    say("\nframes")
    for kind, names in _frames(mover).items():
        say("\n".join(wrapped(f"{kind}: {', '.join(names)}", "  ")))


def _frames(robot: Robot) -> dict[str, list[str]]:
    """Names of the frames by their kind."""
    kinds: dict[str, list[str]] = {}
    for frame in robot.model.frames:
        kinds.setdefault(str(frame.type).lower().replace("_", " "), []).append(frame.name)
    return kinds


def _described(robot: Robot, entry: KnownRobot | None) -> dict[str, object]:
    """Describe a robot as plain data; limits in rad, m, s, N m, N, null where there is none.

    Limits of rates and efforts are magnitudes, or [lower, upper] where these differ.
    """
    from robotraj.cli.conclude import number

    limits = robot.limits
    joints = [
        {
            "name": name,
            "unit": unit,
            "position": [number(side[i]) for side in limits.sides("position")],
            **{name: _rate(*(float(side[i]) for side in limits.sides(name))) for name in RATES},
            "actuated": name in robot.actuated,
        }
        for i, (name, unit) in enumerate(zip(limits.joints, robot.units, strict=True))
    ]
    return {
        "name": robot.name,
        "description": None if entry is None else entry.description,
        "licence": None if entry is None else entry.licence,
        "nq": robot.nq,
        "nv": robot.nv,
        "nu": robot.nu,
        "root": robot.root,
        "joints": joints,
        "warnings": list(limits.warnings(robot.actuated)),
        "frames": _frames(robot),
    }


def _rate(low: float, high: float) -> object:
    from robotraj.cli.conclude import number

    return number(high) if low == -high else [number(low), number(high)]
