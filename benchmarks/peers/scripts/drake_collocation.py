"""Drake's DirectCollocation (Hermite-Simpson, controls linear between knots) on a task; the solver by name."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.planning import DirectCollocation
from pydrake.solvers import IpoptSolver, SnoptSolver, SolverOptions
from pydrake.systems.framework import InputPortSelection
from pydrake.systems.primitives import LinearSystem
from pydrake.trajectories import PiecewisePolynomial
from report import Clock, Report, inside, requested_task, urdf
from tasks import Task

SECONDS = 120.0


def plant_of(task: Task) -> MultibodyPlant:
    """Parse the robot, weld it to the ground and give it its motors."""
    plant = MultibodyPlant(0.0)
    (robot,) = Parser(plant).AddModels(urdf(task))
    ground = plant.get_body(plant.GetBodyIndices(robot)[0])
    if len(plant.GetBodiesWeldedTo(plant.world_body())) == 1:  # a URDF whose root is called world is welded already
        plant.WeldFrames(plant.world_frame(), ground.body_frame())
    for i in task.actuated:
        plant.AddJointActuator(f"motor{i}", plant.GetJointByName(task.joints[i]))
    plant.Finalize()
    assert [plant.GetJointByName(name).velocity_start() for name in task.joints] == list(range(len(task.joints)))
    return plant


def block() -> LinearSystem:
    """T1's block, which needs no URDF: quicker than a plant."""
    return LinearSystem(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.eye(2), np.zeros((2, 1)))


def solve(task: Task) -> None:
    """Solve a task with the solver that PEERS_SOLVER names."""
    solver, name = {"ipopt": (IpoptSolver(), "max_cpu_time"), "snopt": (SnoptSolver(), "Time limit")}[
        os.environ["PEERS_SOLVER"]
    ]
    n, nq = task.intervals, len(task.joints)
    least, most = task.durations
    port: Any = InputPortSelection.kUseFirstInputIfItExists
    system: Any = block() if task.urdf == "block" else plant_of(task)
    if isinstance(system, MultibodyPlant):
        port = system.get_actuation_input_port().get_index()
    program = DirectCollocation(
        system, system.CreateDefaultContext(), n + 1, least / n, most / n, input_port_index=port
    )
    program.AddEqualTimeIntervalsConstraints()
    prog = program.prog()
    start, end = (np.r_[q, np.zeros(nq)] for q in (task.start, task.end))
    prog.AddBoundingBoxConstraint(start, start, program.initial_state())
    prog.AddBoundingBoxConstraint(end, end, program.final_state())
    lower = np.r_[task.position[0], [-v for v in task.velocity]]
    upper = np.r_[task.position[1], task.velocity]
    effort = np.array(task.effort)
    for k in range(n + 1):
        prog.AddBoundingBoxConstraint(lower, upper, program.state(k))
        prog.AddBoundingBoxConstraint(-effort, effort, program.input(k))
    if task.objective == "effort":
        u = program.input()
        program.AddRunningCost(u.dot(u))
    else:
        program.AddFinalCost(program.time())
    line = PiecewisePolynomial.FirstOrderHold([0.0, task.guess], np.column_stack([start, end]))
    program.SetInitialTrajectory(PiecewisePolynomial(), line)
    options = SolverOptions()
    options.SetOption(solver.id(), name, SECONDS)
    with Clock() as clock:
        result = solver.Solve(prog, None, options)
    report = Report(
        (clock.wall, clock.processor), -1, result.is_success(), str(result.get_solution_result()).split(".")[-1]
    )
    t = inside(program.GetSampleTimes(result))
    x, u = program.ReconstructStateTrajectory(result), program.ReconstructInputTrajectory(result)
    states = np.array([x.vector_values(row).T for row in t])
    report.write(t, states[..., :nq], states[..., nq:], np.array([u.vector_values(row).T for row in t]))


if __name__ == "__main__":
    solve(requested_task())
