"""A compass walker walks down a slope without torque, and on level ground with least effort."""

import numpy as np

import robotraj as rt

walker = rt.load("compass_walker", root="planar")
legs = {"left_hip": "right_hip", "left_foot": "right_foot"}
# One motor acts between the legs: its equal and opposite torques do not turn the hip's own mass.
motor = rt.PathConstraint(lambda point: point.tau[0] + point.tau[1], 0, 0, name="one motor", unit="N m")

for name, descent, length in (("downhill", 0.0525, rt.between(0.3, 0.8)), ("level", 0.0, 0.4)):
    ground = rt.terrain.Slope(-np.tan(descent))

    def height(point, ground=ground):
        """Height of the swing foot over the ground. It is zero at touchdown; stiff legs scuff before that."""
        foot = point.frame("right_foot").position
        return foot[2] - ground.height(foot[0], foot[1])

    step = rt.Phase(
        walker,
        duration=(0.6, 1.2),
        start=rt.State(q={"root_pitch": 0}),
        contacts=[rt.PointContact("left_foot", ground=ground)],
        parameters={"left_foot.x": 0},
        constraints=[motor, rt.AtEnd(rt.PathConstraint(height, 0, 0, name="foot on the ground"))],
        objective=rt.Effort(),
        name=name,
    )
    mirror = rt.Mirror(legs, displacement={"q.root_x": length, "q.root_z": None})
    gait = rt.Problem([step], [rt.Touchdown(0, 0, repeat=mirror)])
    solution = rt.plan(gait, mesh=rt.Mesh(8, rt.schemes.LobattoIIIA(4)), tolerance=1e-6)
    print(solution)
    angles, rates = (np.add(state[3:], state[2]) for state in (solution.at(0).q, solution.at(0).v))
    print(f"after the strike: stance, swing leg at {angles} rad, {rates} rad/s; a step takes {solution.duration:.6f} s")
    print(report := rt.validate(solution))
    report.check(drift=1e-3)
    print("wrote", rt.replay(solution, f"10_{name}.html", periods=6, report=report))
