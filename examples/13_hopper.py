"""A hopper moves half a metre forward; the solver finds when its foot stands, slips or flies.

The contact is a relaxed complementarity that is tightened step by step. Every interval has one collocation point at its
end, so that an impact is a force that lasts one interval. A simulation in continuous time does not repeat this motion.
Its times of touchdown and liftoff are those for a plan with phases, which can be proved.
"""

import numpy as np

import robotraj as rt

robot = rt.load("hopper", root="planar")
still = {"root_z": 0.5, "root_pitch": 0.0, "hip": 0.0, "leg": 0.5}
hop = rt.Phase(
    robot,
    duration=1.0,
    contacts=[rt.contacts.ImplicitContact("foot", friction=0.8, relaxation=1e-4)],
    start=rt.State(q=still | {"root_x": 0.0}, v=0),
    end=rt.State(q=still | {"root_x": 0.5}, v=0),
    objective=rt.Effort({"hip": 1.0, "leg": 0.01}),
    name="hop",
)
# First the ground pushes from a distance. Tightened from here in these steps, the hops do not depend on round-off.
stages = rt.planning.tightening(hop, np.geomspace(20.0, 1e-3, 10).tolist())
solution = rt.plan(hop, mesh=rt.Mesh(40, rt.schemes.RadauIIA(1)), continuation=stages)
print(solution)

middles = 0.5 * (solution.knots[1:] + solution.knots[:-1])
stands = solution.at(middles).forces["foot"][:, 2] > 1.0
changes = np.flatnonzero(np.diff(stands)) + 1
times = ", ".join(f"{solution.knots[i]:.3f}" for i in changes)
print(f"the foot stands {np.mean(stands):.0%} of the time; it lifts off and touches down at t = {times} s")
print("wrote", rt.replay(solution, "13_hopper.html"))
