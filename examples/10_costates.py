"""The indirect view: costates of a direct plan, Pontryagin's conditions, and a polish to round-off."""

import numpy as np

import robotraj as rt

block = rt.load("block")
move = rt.Phase(
    block,
    duration=(0.1, 200.0),
    start=rt.State(q=0, v=0),
    end=rt.State(q=10, v=0),
    objective=rt.Duration(),
    name="block, minimum time",
)
direct = rt.plan(move, tolerance=1e-6)
print(direct)
print(rt.conditions(direct))

polished = rt.polish(direct)
print(polished)
(switch,) = polished.switching_times["tau.slider"]
print(f"switching time {switch:.12f} s, exactly sqrt(10) = {np.sqrt(10):.12f} s")

arm = rt.load("cartpole")
swing_up = rt.Phase(
    arm,
    duration=2.0,
    start=rt.State(q=[0, 0], v=0),
    end=rt.State(q=[1, np.pi], v=0),
    objective=rt.Effort(),
    name="cart-pole swing-up",
)
print(rt.polish(rt.plan(swing_up, tolerance=1e-6)))
