"""Robots of all kinds of joints move as in MuJoCo, which reads a file of its own; and serve from plan to page."""

from __future__ import annotations

import numpy as np
import pytest

import robotraj as rt
from robotraj.robot.coupling.dynamics import accelerations
from tests.robot.drawn_trees import DrawnTree

mujoco = pytest.importorskip("mujoco", reason="needs the extra: pip install 'robotraj[mujoco]'")


class Judge:
    """MuJoCo's equations of a tree, projected on the joints that follow no other."""

    def __init__(self, tree: DrawnTree, robot: rt.Robot) -> None:
        self.model = mujoco.MjModel.from_xml_string(tree.mjcf)
        self.data = mujoco.MjData(self.model)
        every = [self.model.joint(i).name for i in range(self.model.njnt)]
        self.rates, self.offsets = tree.coupling(every, list(robot.velocity_names))

    def __call__(self, q, v, tau):
        """Return the accelerations: (S' M S)^-1 (tau + S' (passive - bias))."""
        model, data, rates = self.model, self.data, self.rates
        data.qpos[:], data.qvel[:] = rates @ q + self.offsets, rates @ v
        mujoco.mj_forward(model, data)
        mass, column = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
        for i, unit in enumerate(np.eye(model.nv)):
            mujoco.mj_mulM(model, data, column, unit)
            mass[i] = column
        return np.linalg.solve(rates.T @ mass @ rates, tau + rates.T @ (data.qfrc_passive - data.qfrc_bias))


def drawn(seed, folder):
    tree = DrawnTree.of(seed)
    path = folder / "tree.urdf"
    path.write_text(tree.urdf, encoding="utf-8")
    return tree, rt.load(path, springs=tree.springs, rotors=tree.rotors)


@pytest.mark.parametrize("seed", range(20))
def test_accelerations_are_those_of_mujoco(seed, tmp_path):
    tree, robot = drawn(seed, tmp_path)
    judge, rng = Judge(tree, robot), np.random.default_rng(seed)
    for _ in range(3):
        q, v, tau = (size * rng.uniform(-1, 1, robot.nv) for size in (1.0, 1.0, 5.0))
        applied = tau - robot.damping * v
        for joint, stiffness, rest in robot.springs:
            i = robot.velocity_names.index(joint)
            applied[i] -= stiffness * (q[i] - rest)
        own = accelerations(robot.model, robot.model.createData(), q, v, applied)
        expected = judge(q, v, tau)
        np.testing.assert_allclose(own, expected, atol=1e-9 * (1.0 + np.abs(expected).max()))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 6, 8])
def test_a_plan_is_proved_followed_stored_shown_and_stated_in_a_file(seed, tmp_path):
    """Tree 1 has a ball, whose plan would pass through the pitch at which its speeds have no bound."""
    tree, robot = drawn(seed, tmp_path)
    rng, names = np.random.default_rng(seed), robot.velocity_names
    lower, upper = np.maximum(robot.limits.position_lower, -1.0), np.minimum(robot.limits.position_upper, 1.0)
    start, end = 0.5 * (lower + upper) + 0.15 * (upper - lower) * rng.uniform(-1, 1, (2, robot.nq))
    phase = rt.Phase(robot, 1.0, rt.State(q=start, v=0), rt.State(q=end, v=0), rt.Effort(), name="move")
    solution = rt.plan(phase, progress=False, time_limit=20)
    assert solution.proof.holds and rt.validate(solution).passed
    assert rt.witness.second_opinion(solution).completed
    judge, samples = Judge(tree, robot), solution.at(np.linspace(0.0, 1.0, 21))
    for q, v, a, tau in zip(samples.q, samples.v, samples.a, samples.tau, strict=True):
        expected = judge(q, v, tau)
        np.testing.assert_allclose(a, expected, atol=1e-7 * (1.0 + np.abs(expected).max()))
    again = rt.load_solution(solution.save(tmp_path / "move.npz"))
    assert rt.validate(again).passed
    rt.replay(again, tmp_path / "move.html")
    assert "l5" in (tmp_path / "move.html").read_text(encoding="utf-8")

    def table(values):
        return "{ " + ", ".join(f"{name} = {float(value)!r}" for name, value in zip(names, values, strict=True)) + " }"

    options = [
        f"[robot.{key}]\n" + "".join(f"{name} = {[*map(float, pair)]}\n" for name, pair in pairs.items())
        for key, pairs in (("springs", tree.springs), ("rotors", tree.rotors))
    ]
    (tmp_path / "move.toml").write_text(
        "\n".join(
            [
                '[robot]\nsource = "tree.urdf"',
                *options,
                '[[phases]]\nname = "move"\nduration = 1.0\nobjective = "Effort"',
                f"start = {{ q = {table(start)}, v = 0 }}\nend = {{ q = {table(end)}, v = 0 }}",
            ]
        ),
        encoding="utf-8",
    )
    stated = rt.load_problem(tmp_path / "move.toml").plan()
    assert stated.objective == pytest.approx(solution.objective, rel=1e-9)
