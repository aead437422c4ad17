"""The name of a repeating gait in users' words, from its footholds: "trot at 0.33 m/s"."""

from __future__ import annotations

import numpy as np

from robotraj.replay_page.footholds import footholds
from robotraj.solution.cycles.gait_cycles import CyclePhase, GaitCycles

STILL = 1e-3
"""Speed [m/s] below which a gait stays in its place."""
FOUR = 4


def gait_words(cycles: GaitCycles) -> str:
    """Name a gait by the feet that it holds and its speed over the ground; "" for a plan that does not repeat.

    Two feet walk, or run where no foot is held for a while; one foot hops. Four feet or more crawl while at least
    three are held. Pairs of feet trot where they are diagonal, pace on one side, and bound across.
    """
    if cycles.cycle_map is None:
        return ""
    phases = [cycles.phase(index, period) for period in (0, 1) for index in range(len(cycles.solution.phases))]
    held = [[hold.name for hold in footholds(phase)] for phase in phases]
    feet = {name for names in held for name in names}
    if not feet:
        return ""
    fewest = min(len(names) for names in held if names)
    flies = any(not names for names in held)
    if len(feet) == 1:
        word = "hop"
    elif len(feet) < FOUR:
        word = "run" if flies else "walk"
    elif fewest > FOUR // 2:
        word = "crawl"
    else:
        word = _pairs(next(phase for phase, names in zip(phases, held, strict=True) if len(names) == fewest))
    speed = float(np.linalg.norm(cycles.cycle_map.moved[:2])) / cycles.period
    return f"{word} at {speed:.2g} m/s" if speed > STILL else f"{word} in place"


def _pairs(phase: CyclePhase) -> str:
    """Name a gait by where the two feet lie that are held together."""
    places = [hold.place for hold in footholds(phase)]
    if len(places) != FOUR // 2 or any(len(place) < len("xyz") for place in places):
        return "gait"
    ahead, aside = np.abs(places[0] - places[1])[:2]
    if min(ahead, aside) > 0.3 * max(ahead, aside):
        return "trot"
    return "pace" if ahead > aside else "bound"
