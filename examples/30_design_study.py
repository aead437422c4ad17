"""A design study: which way is better, which gear and length are best for two motions, and effort against time."""

import robotraj as rt

arm = rt.load("two_link_arm")


def reach(case: dict[str, float], goal: float, duration: float = 6.0) -> rt.Phase:
    """Reach ``goal`` [rad] with a forearm that carries a motor of gear ratio n; the motor's torque is tau / n."""
    return rt.Phase(
        arm,
        duration,
        rt.State(q=[0.0, 0.3], v=0),
        rt.State(q=[goal, 0.5], v=0),
        rt.Lagrange(lambda point: point.tau[0] ** 2 + (30.0 * point.tau[1] / point.p["n"]) ** 2),
        parameters=case,
        design={"n": rt.design.GearRatio("elbow", 2e-5), "load": rt.design.Payload("tip")},
    )


solution = rt.plan(reach({"n": 40.0, "load": 0.1}, 1.2))
print("slopes:", {name: solution.sensitivity(name) for name in ("n", "load", "duration")})

best = rt.applications.codesign(
    lambda case: [reach({**case, "load": load}, goal) for goal, load in ((0.8, 0.0), (1.2, 0.1))],
    {"n": (20.0, 200.0)},
    accuracy=1e-3,
)
print(best)


def weighted(price: float) -> rt.Phase:
    """Effort, and a price of each second."""
    ends = rt.State(q=[0.0, 0.3], v=0), rt.State(q=[1.2, 0.5], v=0)
    return rt.Phase(arm, (4.5, 12.0), *ends, rt.Effort() + price * rt.Duration())


print(rt.applications.pareto(weighted, (0.05, 2.0), points=5))
