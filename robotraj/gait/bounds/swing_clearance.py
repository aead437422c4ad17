"""Clearance of swinging feet: an arc past the standing foot, or a height above the ground."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from robotraj._util.errors import warn
from robotraj._util.values import dataclass
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.contacts.point_on_frame import Spot
from robotraj.dynamics.point import RobotPoint
from robotraj.dynamics.terrain.base import Ground
from robotraj.dynamics.variable import Scalar
from robotraj.gait.feet import foot_contact
from robotraj.gait.supports import GaitTerms, Support
from robotraj.problem.clearance.swinging_feet import TOUCH
from robotraj.problem.constraints.base import Constraint
from robotraj.problem.constraints.clearance import GroundClearance
from robotraj.problem.constraints.heights import RequiredHeight
from robotraj.problem.links.periodic import Mirror, Periodic
from robotraj.robot.robot import Robot

STEP = "step length"
"""Parameter of the phases of mirrored gaits with clearance: displacement of a step along x [m]."""


def partners_of(repeat: Mirror | Periodic | None) -> dict[str, str]:
    """Return the foot on the other side of each foot that a mirror names."""
    return repeat.partner_of if isinstance(repeat, Mirror) else {}


def swing_clearance(
    robot: Robot,
    support: Support,
    swinging: Sequence[str],
    terms: GaitTerms,
    ground: Ground,
    repeat: Mirror | Periodic | None,
    passes: Mapping[str, str] | None,
) -> tuple[list[Constraint], dict[str, float]]:
    """Return the clearance of swinging feet, and the parameters of the phase that it reads.

    In a mirrored gait a foot swings past its standing partner: from one displacement behind the partner's foothold
    to one before it. The same holds in each half of a complete stride. Other feet stay above the ground; the function
    warns of them if the clearance is positive. All corners of a sole stay above the ground.
    """
    if not swinging:
        return [], {}
    if terms.clearance is None:
        return [through_ground([foot_contact(terms.contact, foot).bound_to(robot) for foot in swinging])], {}
    partners = partners_of(repeat) if passes is None else passes
    gain = repeat.displacement.get("q.root_x") if repeat is not None else None
    if passes is not None and isinstance(gain, int | float):
        gain = 0.5 * gain
    rows: list[Constraint] = []
    parameters: dict[str, float] = {}
    level: list[Spot] = []
    low: list[str] = []
    for foot in swinging:
        other, bound = partners.get(foot, foot), foot_contact(terms.contact, foot).bound_to(robot)
        outline = bound.outline()
        if terms.clearance > 0.0 and other in support.feet and isinstance(gain, int | float) and gain != 0.0:
            # Gaits of other lengths have the same rows, since the length is a parameter.
            parameters = {STEP: float(gain)}
            arc = SwingArc(terms.clearance, f"{foot_contact(terms.contact, other).label}.x", STEP)
            rows.append(GroundClearance(bound.touching.plainly, arc, ground))
            level += outline if outline != [bound.touching] else []
        else:
            level += outline
            low.append(foot)
    if low and support.feet and terms.clearance > 0.0:
        warn(
            f"clearance={terms.clearance:g} is not imposed on {', '.join(low)} in {support.name!r}, which only stay "
            "above the ground. It needs a standing partner that the foot passes, and a step of known length. "
            "Add rt.GroundClearance(foot, rt.constraints.SwingApex(...)) for these feet."
        )
    spots = [spot.plainly for spot in level]
    return [*rows, GroundClearance(spots, -TOUCH, ground)] if spots else rows, parameters


def through_ground(feet: Sequence[BoundContact]) -> GroundClearance:
    """Return the constraint without rows that lets swinging feet pass through the ground."""
    return GroundClearance([spot.plainly for foot in feet for spot in foot.outline()], None)


@dataclass(frozen=True)
class SwingArc(RequiredHeight):
    """Height [m] of a swing foot, h = 4 (apex + d) s (1 - s) - d with d = 0.1 mm, s its progress between footholds.

    Halfway, h is the apex; the foot never comes below -d. s increases from 0 to 1 between one step behind and one step
    before the partner's foothold. Without d the inequality would be active at both ends, where the contacts already
    determine the height, and its multipliers would not be unique.

    Attributes
    ----------
    apex : float
        Height halfway [m].
    anchor : str
        Parameter of the phase: world x of the partner's foothold.
    step : str
        Parameter of the phase: displacement of a step along x [m].
    """

    apex: float
    anchor: str
    step: str

    def heights(self, point: RobotPoint, position: Sequence[Scalar]) -> dict[str, Scalar]:
        """Return the least heights at ``position``."""
        progress = 0.5 + 0.5 * (position[0] - point.p[self.anchor]) / point.p[self.step]
        return {
            "ground clearance": -TOUCH,
            "swing apex": 4.0 * (self.apex + TOUCH) * progress * (1.0 - progress) - TOUCH,
        }
