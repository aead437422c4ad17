"""Files of controllers: ROS JointTrajectory, tables of set points, MCAP logs."""

from __future__ import annotations

import csv
import json
import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from robotraj._util.errors import InputError
from robotraj._util.paths import output_path
from robotraj._util.system.whole_files import WholeFile
from robotraj.solution.export.set_points import SetPoints, set_points
from robotraj.solution.export.times import cell, yaml_text
from robotraj.solution.planned import Planned

SECOND = 10**9
"""Nanoseconds."""
WITHOUT_POINT = re.compile(r"(?<![\d.])(\d)e")
"""Mantissa of a number such as 1e-05."""


def to_controller(solution: Planned, path: str | os.PathLike[str], rate: float = 1000.0) -> Path:
    """Write set points of the motors for a controller. The suffix of the path decides the format.

    =========  =========================================================================================================
    suffix     content
    =========  =========================================================================================================
    .yaml      ``trajectory_msgs/JointTrajectory`` of ROS, as ``ros2 topic pub`` and MoveIt read it
    .json      the same message as JSON
    .csv       one row a period with units in its header, the last row at the end of the plan
    .servo     one row a period without header or time, q then v then tau of every motor; the last row repeats the end
    .mcap      ``sensor_msgs/JointState`` messages encoded as JSON; needs ``pip install 'robotraj[mcap]'``
    =========  =========================================================================================================

    Parameters
    ----------
    solution : Solution
        A plan of one robot. Coordinates of a floating or planar root are omitted.
    path : path
        Its directory must exist; an older file is replaced.
    rate : float
        Samples per second [Hz]. Times are strictly ascending, the first and the last exactly those of the plan.

    Returns
    -------
    pathlib.Path
        The file, absolute.

    Raises
    ------
    InputError
        Another suffix, no such directory, a plan of a System, or a rate that is not above 0.
    """
    target = output_path(path, (), "the export")
    write = _WRITERS.get(target.suffix.lower())
    if write is None:
        raise InputError(f"to_controller writes {', '.join(_WRITERS)}; got {str(path)!r}.")
    points = set_points(solution, rate)
    with WholeFile(target) as partial:
        write(points, partial)
    return target


def joint_trajectory(points: SetPoints) -> dict[str, object]:
    """Return the message ``trajectory_msgs/JointTrajectory`` as plain values; its time starts at 0."""
    stamps = np.round((points.t - points.t[0]) * SECOND).astype(np.int64)
    rows = zip(stamps.tolist(), *(part.tolist() for part in (points.q, points.v, points.a, points.tau)), strict=True)
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": list(points.joints),
        "points": [
            {
                "positions": q,
                "velocities": v,
                "accelerations": a,
                "effort": tau,
                "time_from_start": {"sec": stamp // SECOND, "nanosec": stamp % SECOND},
            }
            for stamp, q, v, a, tau in rows
        ],
    }


def _write_json(points: SetPoints, path: Path) -> None:
    path.write_text(json.dumps(joint_trajectory(points), allow_nan=False) + "\n", encoding="utf-8")


def _write_yaml(points: SetPoints, path: Path) -> None:
    """Write block style with one line a list; JSON's lists and strings are YAML's.

    YAML 1.1 reads a number with an exponent as text where its mantissa has no decimal point, as in 1e-05.
    """
    message = joint_trajectory(points)
    lines = ["header:", "  stamp: {sec: 0, nanosec: 0}", '  frame_id: ""']
    lines += [f"joint_names: [{', '.join(yaml_text(name) for name in points.joints)}]", "points:"]
    known = message["points"]
    assert isinstance(known, list)
    for point in known:
        stamp = point["time_from_start"]
        values = {
            name: WITHOUT_POINT.sub(r"\1.0e", json.dumps(each))
            for name, each in point.items()
            if name != "time_from_start"
        }
        lists = [f"{name}: {text}" for name, text in values.items()]
        lines += [f"  - {lists[0]}", *(f"    {each}" for each in lists[1:])]
        lines.append(f"    time_from_start: {{sec: {stamp['sec']}, nanosec: {stamp['nanosec']}}}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _write_csv(points: SetPoints, path: Path) -> None:
    headings = ["t [s]"]
    for kind, per in (("q", ""), ("v", "/s"), ("a", "/s^2")):
        headings += [f"{kind}.{joint} [{unit}{per}]" for joint, unit in zip(points.joints, points.units, strict=True)]
    efforts = ("N m" if unit == "rad" else "N" for unit in points.units)
    headings += [f"tau.{joint} [{unit}]" for joint, unit in zip(points.joints, efforts, strict=True)]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([cell(heading) for heading in headings])
        for row in np.column_stack([points.t, points.q, points.v, points.a, points.tau]).tolist():
            writer.writerow([repr(value) for value in row])


def _write_servo(points: SetPoints, path: Path) -> None:
    """Write only numbers. Every row lasts one period; the last row is the end of the plan, at or after its time."""
    rows = np.column_stack([points.q, points.v, points.tau])
    path.write_text("\n".join(" ".join(f"{value:.9g}" for value in row) for row in rows) + "\n", encoding="utf-8")


def _write_mcap(points: SetPoints, path: Path) -> None:
    try:
        from mcap.writer import Writer
    except ImportError as error:
        raise InputError("A .mcap file needs the package mcap: pip install 'robotraj[mcap]'.") from error
    numbers = {"type": "array", "items": {"type": "number"}}
    names = {"type": "array", "items": {"type": "string"}}
    fields: Mapping[str, object] = {"name": names, "position": numbers, "velocity": numbers, "effort": numbers}
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="robotraj")
        text = json.dumps({"type": "object", "properties": fields}).encode()
        schema = writer.register_schema(name="sensor_msgs/JointState", encoding="jsonschema", data=text)
        channel = writer.register_channel(schema_id=schema, topic="/joint_states", message_encoding="json")
        rows = zip(*(part.tolist() for part in (points.t, points.q, points.v, points.tau)), strict=True)
        for t, q, v, tau in rows:
            stamp = round((t - points.t[0]) * SECOND)
            message = {"name": list(points.joints), "position": q, "velocity": v, "effort": tau}
            writer.add_message(channel, log_time=stamp, publish_time=stamp, data=json.dumps(message).encode())
        writer.finish()


_WRITERS: Mapping[str, Callable[[SetPoints, Path], None]] = {
    ".yaml": _write_yaml,
    ".json": _write_json,
    ".csv": _write_csv,
    ".servo": _write_servo,
    ".mcap": _write_mcap,
}
