"""How fast a robot can walk at most: an estimate from the joint speeds of its legs.

While a foot stands, it moves backwards relative to the root at the speed of the gait v, over the stroke b D, where D is
the displacement of the root in a stride and b the share of the stride in which the foot stands. It comes back in the
share 1 - b. The least time of a stroke is

    T = min over strokes of the integral dx / V(x),

where V(x) is the greatest speed of the foot relative to the root along x, by the limits of the joint speeds, in the
best of seeded random configurations with the foot below the root at x (``leg_samples``). So

    v <= min(1, (1 - b) / b) b D / T.

The bound omits torques and the heights of the root, so that robots walk at about half of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.errors import InputError
from robotraj.gait.capability.leg_samples import LegSamples, sample_legs
from robotraj.gait.supports import Support
from robotraj.robot.robot import Robot

CELLS = 12
"""Number of parts of a stroke."""
EASY = 0.25
"""Part of the speed of the standing leg up to which nothing is estimated."""
MODEST, MODEST_STEP = 0.2, 0.3
"""Parts of the bound and of the length of a leg that a message names as ones that would do."""


def check_speed(
    robot: Robot,
    phases: Sequence[Support],
    parts: Sequence[float],
    sides: Mapping[str, str],
    length: float,
    time: float,
    standing: Array,
    friction: float,
    margin: float,
    steps: float = 1.0,
) -> None:
    """Refuse a gait that is faster than the joint speeds of the legs allow.

    Parameters
    ----------
    robot : Robot
    phases : sequence of Support
        Phases of one half of the stride.
    parts : sequence of float
        Fractions of the phases in the duration of the half.
    sides : mapping of str to str
        Foot on the other side of each foot.
    length : float
        Displacement along x in one half [m].
    time : float
        Greatest duration of one half [s].
    standing, friction, margin
        As for ``sample_legs``.
    steps : float
        Number of ``step_length=`` in the length, for the message.

    Raises
    ------
    InputError
        The message has the speed, the bound, and a step that would do.
    """
    speed = abs(length) / time
    feet = sorted(sides)
    at_rest = sample_legs(robot, feet, standing, friction, margin, 0)
    if at_rest is None or speed <= EASY * float(at_rest.speeds((1.0, 0.0, 0.0)).min()):
        return
    shares = list(standing_shares(phases, parts, sides).values())
    samples = sample_legs(robot, feet, standing, friction, margin)
    assert samples is not None
    bounds = [_bound(samples, f, share, 2.0 * abs(length)) for f, share in enumerate(shares)]
    f = int(np.argmin(bounds))
    if speed <= bounds[f]:
        return
    straight = float(-samples.places[f, :, 2].min())
    step = min(abs(length), MODEST_STEP * straight)
    slowest = step / (MODEST * min(_bound(samples, f, share, 2.0 * step) for f, share in enumerate(shares)))
    natural = float(np.sqrt(straight / np.linalg.norm(robot.model.gravity.linear)))
    raise InputError(
        f"The gait moves at {speed:.3g} m/s, {abs(length):.3g} m in {time:.3g} s. By the velocity limits of the joints "
        f"of its leg, {feet[f]!r} of {robot.name!r} allows {bounds[f]:.2g} m/s at most with such steps. "
        f"step_length={np.sign(length) * step / steps:.2g} with duration={max(slowest, natural) / steps:.2g} would do."
    )


def standing_shares(phases: Sequence[Support], parts: Sequence[float], sides: Mapping[str, str]) -> dict[str, float]:
    """Return the share of the stride in which each foot stands, in the order of their names.

    The parameters are those of ``check_speed``.
    """
    held = {
        foot: sum(part for phase, part in zip(phases, parts, strict=True) if foot in phase.feet) / sum(parts)
        for foot in sorted(sides)
    }
    return {foot: 0.5 * (held[foot] + held[sides[foot]]) for foot in held}


def _bound(samples: LegSamples, foot: int, share: float, stride: float) -> float:
    """Return the greatest speed of a gait for one foot [m/s]."""
    stroke = share * stride
    if not stroke > 0.0 or share >= 1.0:
        return float(np.inf)
    places, speeds = samples.places[foot], samples.speeds((1.0, 0.0, 0.0))[foot]
    below = places[:, 2] < 0.0
    cell = stroke / CELLS
    cells = np.round(places[below, 0] / cell).astype(int)
    if not cells.size:
        return float(np.inf)
    fastest = np.zeros(max(int(np.ptp(cells)) + 1, CELLS))
    np.maximum.at(fastest, cells - cells.min(), speeds[below])
    # Cells without a sample do not slow the foot down.
    fastest[fastest == 0.0] = speeds[below].max()
    times = np.concatenate([[0.0], np.cumsum(cell / fastest)])
    least = float(np.min(times[CELLS:] - times[:-CELLS]))
    return min(1.0, (1.0 - share) / share) * stroke / least
