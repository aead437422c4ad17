"""The data of one solution for the page's scripts."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from robotraj.replay_page.charts.curves import curves
from robotraj.replay_page.charts.own_curves import OwnCurves
from robotraj.replay_page.colors import css
from robotraj.replay_page.contacts import held
from robotraj.replay_page.footholds import contact_names
from robotraj.replay_page.groups import groups_of
from robotraj.replay_page.verdict import Validation, proof_data, verdict
from robotraj.robot.robot import Robot
from robotraj.solution.cycles.gait_cycles import GaitCycles


def run_data(
    robot: Robot | None,
    cycles: GaitCycles,
    scene: dict[str, object] | None,
    label: str,
    number: int,
    report: Validation | None,
    own: OwnCurves,
) -> dict[str, object]:
    """Describe a solution, ready for JSON.

    Parameters
    ----------
    robot : Robot or None
        None for a system.
    cycles : GaitCycles
        The solution over its periods.
    scene : dict or None
        Its part of the 3D view.
    label : str
        Its name on the page.
    number : int
        Its place among the solutions of the page, which decides its tint.
    report : Report or None
        Its validation.
    own : OwnCurves
        Curves of the caller.

    Returns
    -------
    dict
        ``label``, ``tint``, ``status`` (text, colour), ``start`` and ``end`` [s], ``phases`` (name, start, end, knots),
        ``proof``, ``charts``, ``groups``, ``held``, ``impacts`` [s], ``colors`` of contacts and ``scene``.
    """
    phases = [
        {
            "name": part.name,
            "start": float(part.t0),
            "end": float(part.t0 + part.duration),
            "knots": np.round(part.knots, 6).tolist(),
        }
        for part in cycles.phases
    ]
    charts = curves(cycles, own)
    grouped = charts[: len(charts) - len(own.expressions)]
    labels = [series["label"] for chart in grouped for series in chart["series"]]
    contacts = contact_names(cycles) if robot is not None else []
    return {
        "label": label,
        "tint": css(number),
        "status": asdict(verdict(cycles.solution, report)),
        "start": phases[0]["start"],
        "end": phases[-1]["end"],
        "phases": phases,
        "proof": proof_data(cycles.solution, report),
        "charts": charts,
        "groups": groups_of(robot, cycles, list(dict.fromkeys(labels))),
        "held": held(cycles) if robot is not None else [],
        "impacts": sorted({impact.t for impact in cycles.impacts}),
        "colors": {name: css(k) for k, name in enumerate(contacts)},
        "scene": scene,
    }
