"""The periodic step of a five-link biped, as in Kelly's tutorial: least effort, without and with lifted feet."""

import numpy as np

import robotraj as rt

published = {("five_link", 0.0): 469.650, ("five_link_table", 0.0): 390.7905}
for name, clearance in (("five_link", 0.0), ("five_link", 0.1), ("five_link_table", 0.0)):
    robot = rt.load(name, root="planar")
    # One step of 0.5 m in 0.7 s. The left foot stands, the right one lands with an impact; the next step mirrors it.
    step = rt.gait.walk(
        robot,
        step_length=0.5,
        duration=0.7,
        contact=rt.PointContact("left_foot", friction=2.0),
        clearance=clearance,
        upright=None,
    )
    solution = rt.plan(step, tolerance=1e-6)
    known = published.get((name, clearance), "not published")
    print(f"{name}, foot lifted by {clearance} m: {solution.objective:.4f} (known: {known})")
    print(solution)
    report = rt.validate(solution)
    report.check(drift=1e-3)
    (impulse,) = solution.impulses
    print("impulse of the strike:", ", ".join(f"{k} {v:.2f} N s" for k, v in impulse.items()))
    print("greatest torques [N m]:", np.abs(solution.at(np.linspace(0, 0.7, 500)).tau).max(axis=0).round(2))
    print("wrote", rt.replay(solution, f"11_{name}_{clearance}.html", periods=6, report=report))
print(report)
