"""Costates of a direct plan, Pontryagin's conditions, and a polish of the solution to round-off."""

import numpy as np

import robotraj as rt

block = rt.load("block")
ends = rt.State(q=0, v=0), rt.State(q=10, v=0)
direct = rt.plan(rt.Phase(block, (0.1, 200.0), *ends, objective=rt.Duration(), name="fastest"), tolerance=1e-6)
print(direct)
print(rt.indirect.conditions(direct))

polished = rt.indirect.polish(direct)
print(polished)
(switch,) = polished.switching_times["tau.slider"]
print(f"switching time {switch:.12f} s, exactly sqrt(10) = {np.sqrt(10):.12f} s")

# Bryson and Denham's problem: the motion reaches a bound on x, follows it and leaves it; the costate of x jumps there.
# Cut at these junctions, the motion has three phases of free duration, and the jumps lie at their ends.
mass = rt.System(["x", "v"], ["u"], lambda point: [point.x["v"], point.u["u"]])
effort = rt.Lagrange(lambda point: 0.5 * point.u["u"] ** 2)
bounce = rt.Phase(mass, 1.0, rt.State([0, 1]), rt.State([0, -1]), effort, states={"x": rt.between(None, 1 / 9)})
arcs, guess = rt.indirect.cut_at_junctions(rt.plan(bounce, tolerance=1e-6))
entry, arc, _ = rt.indirect.costates(rt.plan(arcs, rt.Mesh(3, rt.schemes.RadauIIA(3)), guess, rt.Ipopt(1e-12))).phases
print(f"the bound is met at {arc.solution.t0:.6f} s (exactly 1/3); the costates jump there")
print(f"from {entry.final.round(4)} (exactly 18, 0) to {arc.initial.round(4)} (exactly 0, 0)\n")

arm = rt.load("cartpole")
swing_up = rt.Phase(
    arm,
    duration=2.0,
    start=rt.State(q=[0, 0], v=0),
    end=rt.State(q=[1, np.pi], v=0),
    objective=rt.Effort(),
    name="cart-pole swing-up",
)
swung = rt.plan(swing_up, tolerance=1e-6)
print(rt.indirect.polish(swung))
print("wrote", rt.replay(swung, "17_costates.html"))
