"""Plan an arm and its motion together: the lengths of its links, the mass of its upper arm, and the torques."""

import robotraj as rt

arm = rt.load("two_link_arm")  # two links of 1 m and 1 kg on vertical axes, a load of 1 kg at the tip
task = {
    "duration": 1.5,
    "start": rt.State(v=0),
    "end": rt.State(v=0),
    "objective": rt.Effort(),
    "limits": arm.limits.with_(effort=20.0, velocity=10.0),
}
carry = [
    rt.AtStart(rt.FramePosition("tip", {"x": 1.1, "y": -0.5})),
    rt.AtEnd(rt.FramePosition("tip", {"x": 0.6, "y": 1.2})),
]
bent = rt.guess.Keyframes([0, 1], [rt.State(q=[0.5, -1.8], v=0), rt.State(q=[1.9, -1.7], v=0)])
as_built = rt.plan(rt.Phase(arm, constraints=carry, **task), mesh=rt.Mesh(60), guess=bent)

# A rod of 1 kg/m: its mass equals its length.
rod = rt.AtStart(rt.PathConstraint(lambda p: p.p["mass"] - p.p["upper"], lower=0, upper=0, name="rod", unit="kg"))
together = rt.Phase(
    arm,
    constraints=[*carry, rod],
    parameters={"upper": rt.between(0.3, 1.5), "mass": rt.between(0.3, 1.5), "fore": rt.between(0.3, 1.5)},
    design={
        "upper": rt.design.LinkLength("shoulder", along=(1, 0, 0)),
        "mass": rt.design.BodyMass("upper_arm"),
        "fore": rt.design.LinkLength("elbow"),
    },
    name="carry",
    **task,
)
designed = rt.plan(together, mesh=rt.Mesh(60), guess=bent)
print(f"effort: {as_built.objective:.3f} as built, {designed.objective:.3f} N^2 m^2 s as designed")
print({name: round(value, 3) for name, value in designed.phases[0].parameters.items()})
report = rt.validate(designed)
report.check()
print("wrote", rt.replay(designed, "08_design.html", report=report))
