"""The figures of a validation, and their thresholds."""

from __future__ import annotations

from robotraj._util.checks import number
from robotraj._util.curves.teeth import SMOOTH
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.solution.proof import Proof
from robotraj.solution.reserves.shares import Share
from robotraj.solution.violation import Violation
from robotraj.witness.checks.clearance import Clearance
from robotraj.witness.checks.energy import Energy
from robotraj.witness.checks.residual import Residual
from robotraj.witness.checks.smoothness import Teeth
from robotraj.witness.checks.torques import RateError, TorqueError
from robotraj.witness.contacts.foot_order import FootOrder
from robotraj.witness.contacts.ground import SwingingFoot
from robotraj.witness.contacts.impact import Impact
from robotraj.witness.contacts.links_over_ground import LinkDepth
from robotraj.witness.contacts.slip_and_friction import Holding
from robotraj.witness.cost.objective import ObjectiveCheck
from robotraj.witness.cost.second_solve import SecondSolve
from robotraj.witness.plants.plant import Landing
from robotraj.witness.robustness.followed import Followed
from robotraj.witness.simulation.closed_loop import ClosedLoop
from robotraj.witness.simulation.drift import Drift

DISTANCE = "clearance"
"""Name of the violations of a distance."""


@dataclass(frozen=True)
class Tolerances(OneLine):
    """Thresholds of ``Report.passed``; a figure whose threshold is None is reported but not judged.

    Attributes
    ----------
    local : float or None
        Largest local error |simulated - planned| relative to the size of the state (``robot.size.state_sizes``). It is
        measured at the ends of short parts of the plan, each simulated from its planned state.
    tracking : float or None
        Largest deviation with feedback, relative to the sizes of the states; that of velocities to ten times these.
    limits : float
        Largest violation of a limit, constraint, link or boundary condition, relative to ``Row.size``.
    contact : float or None
        Largest slip [m], sink [m] and turn [rad] of a contact between collocation points.
    forces : float or None
        Largest violation of limits on normal force, friction and centre of pressure between collocation points. It is
        relative to the robot's weight, or to the impulse of an impact.
    force_error : float or None
        Largest difference between planned contact forces and those of the equations, relative to the largest force of
        the contact in the phase, or to 5 percent of the robot's weight where that is greater.
    ground : float or None
        Largest depth of a swinging foot or another link below the ground relative to the robot's reach l, and largest
        speed away from the ground at a touchdown relative to sqrt(g l).
    energy : float or None
        |imbalance| of the energy balance relative to ``Energy.scale``.
    residual : float or None
        Residual of the equations between collocation points and jump at knots, in the unit of each.
    drift : float or None
        Largest open-loop drift through all phases, scaled as ``tracking``. Drift of an unstable motion is large however
        good its plan is.
    torques : float or None
        Largest mean error of torques and contact forces over a short window, relative to the joint's own load; and
        of velocities against the derivatives of positions, relative to their sizes.
    objective : float or None
        Largest relative difference between the stated objective and the cost of the motion.
    optimum : float or None
        Largest share of the objective that a second solve from the plan may gain, on meshes twice as fine. It is at
        least the goal of the proof.
    friction : float or None
        Largest deviation of a machine with Coulomb's friction, scaled as ``tracking``.
    smoothness : float or None
        Largest height of teeth of a control that alternate with the mesh, relative to its limit.
    followed : float or None
        Largest deviation of a joint [rad, m] in MuJoCo, which simulates the plan under ``LinearQuadratic()`` if this is
        given. It takes longer than all other checks.

    Raises
    ------
    InputError
        A threshold is no number of at least 0.
    """

    local: float | None = 1e-3
    tracking: float | None = 1e-2
    limits: float = 1e-3
    contact: float | None = 1e-4
    forces: float | None = 1e-3
    force_error: float | None = 2e-2
    ground: float | None = 1e-3
    energy: float | None = None
    residual: float | None = None
    drift: float | None = None
    torques: float | None = 5e-3
    objective: float | None = 2e-3
    optimum: float | None = 3e-3
    friction: float | None = 2e-2
    smoothness: float | None = SMOOTH
    followed: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if name == "limits" or value is not None:
                number(name, value, 0.0)


@dataclass(frozen=True, repr=False)
class Figures(OneLine):
    """All figures of a validation.

    Attributes
    ----------
    local : Drift or None
        Local error by state: parts of the plan simulated one by one. None where the time limit was reached before.
    closed_loop : ClosedLoop
        The simulation with the plan's feedback, and the growth of a small error without it.
    drift : Drift or None
        Final and largest distance of the open-loop simulation from the plan, by state. It has no threshold by default.
    breaches : tuple of Violation
        Bounds violated by more than a solver's tolerance, the worst first; ``violations`` exceed the threshold.
    energy : Energy or None
        None for Systems.
    residual : Residual
    failure : str or None
        Why and when the open-loop simulation stopped before the end; None if it did not.
    tolerances : Tolerances
        The thresholds of ``passed``.
    duration : float
        Duration of the plan [s].
    intervals : int
        Number of intervals of all phases.
    phases : tuple of str
        Names of the phases.
    rtol, atol : float
        Tolerances of every step of the simulations.
    seconds : float
        Processor time of the validation [s].
    unchecked : tuple of str
        Checks that were not made, with reasons: rows of the problem that a file cannot store, and checks after the time
        limit. A plan with unchecked rows does not pass.
    unseen : tuple of str
        Figures without a threshold that were not computed before the time limit.
    landings : tuple of Landing
        Places at which the open-loop simulation set its contacts down.
    holdings : tuple of Holding
        Slip, sink and forces of every contact of every phase.
    impacts : tuple of Impact
    swings : tuple of SwingingFoot
        Depth below the ground and rise at touchdown of every foot in every phase that does not hold it.
    link_depths : tuple of LinkDepth
        Depth of every link below the ground that the feet stand on, in every phase.
    foot_orders : tuple of FootOrder
        Least distance of left from right feet in every phase, and of fore from hind feet whose legs share a plane; legs
        that cross do not pass.
    shares : tuple of Share
        Largest shares of friction cones, soles, torques and speeds that a plan with contacts uses; without a threshold.
    stiff : float or None
        Time [s] from which implicit steps simulated open loop, because the motion is stiff.
    torques : TorqueError or None
        Torques and forces against Pinocchio's; None for Systems, and where the time limit was reached before.
    rates : RateError or None
        Velocities against the derivatives of positions.
    teeth : Teeth or None
        The largest teeth of a control; None without a control that has limits on both sides.
    friction : Drift, str or None
        Deviation of a machine with Coulomb's friction, or why it was not simulated; None without dry friction.
    followed : Followed or None
        The robot in MuJoCo; None where ``followed=`` was not asked for.
    objective : ObjectiveCheck or None
        The stated objective beside the cost of the motion; None where the time limit was reached before.
    second : SecondSolve or None
        A second solve from the plan; None where the plan claims no optimum, or the time limit was reached before.
    proof : Proof or None
        The planner's own measures.
    moves_robot, avoids_collisions, has_friction : bool
        Whether a phase moves a robot, and not a System; whether a phase has a ``CollisionFree``; whether a joint has
        dry friction.
    keeps_smooth_law : bool
        Whether a robot with a free root has dry friction, whose plan is not made by Coulomb's law.
    clearances : tuple of Clearance
        Smallest distance of the exact shapes for every ``CollisionFree``.
    self_collisions : tuple of Clearance
        Links of a robot that overlap, by their exact shapes as solids; each distance is the negative of the depth [m].
        None are allowed.
    own_distances : tuple of Clearance
        For each phase, the pair of links that comes nearest without an overlap, of those that come near.
    unguarded : tuple of str
        What could not be judged, such as links whose shapes were not read or that have none, each with the reason.
    left_out : tuple of str
        Pairs of links that may overlap or need not keep a margin, and links that are not compared with the ground, each
        with the reason. Neighbours in the tree of links are not listed.
    """

    local: Drift | None
    closed_loop: ClosedLoop | None
    drift: Drift | None
    breaches: tuple[Violation, ...]
    energy: Energy | None
    residual: Residual
    failure: str | None
    tolerances: Tolerances
    duration: float
    intervals: int
    phases: tuple[str, ...]
    rtol: float
    atol: float
    seconds: float = 0.0
    unchecked: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()
    landings: tuple[Landing, ...] = ()
    holdings: tuple[Holding, ...] = ()
    impacts: tuple[Impact, ...] = ()
    swings: tuple[SwingingFoot, ...] = ()
    link_depths: tuple[LinkDepth, ...] = ()
    foot_orders: tuple[FootOrder, ...] = ()
    shares: tuple[Share, ...] = ()
    stiff: float | None = None
    torques: TorqueError | None = None
    rates: RateError | None = None
    teeth: Teeth | None = None
    friction: Drift | str | None = None
    followed: Followed | None = None
    objective: ObjectiveCheck | None = None
    second: SecondSolve | None = None
    proof: Proof | None = None
    moves_robot: bool = False
    avoids_collisions: bool = False
    has_friction: bool = False
    keeps_smooth_law: bool = False
    clearances: tuple[Clearance, ...] = ()
    self_collisions: tuple[Clearance, ...] = ()
    own_distances: tuple[Clearance, ...] = ()
    unguarded: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()

    def was_late(self, check: str) -> bool:
        """Whether a check was not made because the time limit was reached."""
        return any(check in entry for entry in self.unchecked)

    @property
    def violations(self) -> tuple[Violation, ...]:
        """Bounds violated by more than the tolerance, the worst first."""
        return tuple(v for v in self.breaches if v.relative > self.tolerances.limits)
