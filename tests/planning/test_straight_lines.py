"""Published problems of bad scales and switching controls converge from the straight line."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

import robotraj as rt
from robotraj.solvers.status import Status


def free_flyer() -> rt.Phase:
    """Fly a robot with four jets to the origin; the fuel is the 1-norm of the thrusts.

    Sakawa, Optimal Control Applications and Methods 20 (1999); Betts, Practical Methods (2010), section 6.13.
    """

    def rates(p: Any) -> list[Any]:
        one, other = p.u["u1"] - p.u["u2"], p.u["u3"] - p.u["u4"]
        push, heading = one + other, p.x["heading"]
        spin = 0.2 * (one - other)
        return [p.x["vx"], p.x["vy"], p.x["w"], push * ca.cos(heading), push * ca.sin(heading), spin]

    jets = ["u1", "u2", "u3", "u4"]
    system = rt.System(["x", "y", "heading", "vx", "vy", "w"], jets, rates)
    pairs = [
        rt.PathConstraint(lambda p: p.u["u1"] + p.u["u2"], upper=1, name="first pair"),
        rt.PathConstraint(lambda p: p.u["u3"] + p.u["u4"], upper=1, name="second pair"),
    ]
    fuel = rt.Lagrange(lambda p: sum(p.u[jet] for jet in jets))
    start = rt.State([-10, -10, np.pi / 2, 0, 0, 0])
    pushes = {jet: rt.between(0, None) for jet in jets}
    return rt.Phase(system, 12.0, start, rt.State([0] * 6), fuel, pairs, controls=pushes)


def hang_glider() -> rt.Phase:
    """Glide as far as possible through a thermal: COPS 3, problem 11; Betts (2010), section 6.5."""

    def rates(p: Any) -> list[Any]:
        x, lift = p.x, p.u["lift"]
        place = (x["x"] / 100.0 - 2.5) ** 2
        sink = x["vy"] - 2.5 * (1 - place) * ca.exp(-place)
        speed = ca.sqrt(x["vx"] ** 2 + sink**2)
        # Drag and lift [N] per speed [m/s] and kilogram, m = 100 kg.
        common = 0.5 * 1.13 * 14.0 * speed / 100.0
        drag, up = (0.034 + 0.069662 * lift**2) * common, lift * common
        return [x["vx"], x["vy"], -up * sink - drag * x["vx"], up * x["vx"] - drag * sink - 9.80665]

    system = rt.System(["x", "y", "vx", "vy"], ["lift"], rates)
    start, end = [0, 1000, 13.2275675, -1.28750052], {"y": 900, "vx": 13.2275675, "vy": -1.28750052}
    ahead = {"x": rt.between(0, None), "vx": rt.between(0, None)}
    far = rt.Mayer(lambda a, b: -b.x["x"])
    lifts = {"lift": rt.between(0, 1.4)}
    return rt.Phase(system, (1, 200), rt.State(start), rt.State(end), far, states=ahead, controls=lifts)


def goddard() -> rt.Phase:
    """Climb as high as possible with a given propellant, in feet, pounds and seconds: Betts (2010), section 4.14."""

    def rates(p: Any) -> list[Any]:
        drag = 5.4915348492e-5 * p.x["v"] ** 2 * ca.exp(-p.x["h"] / 23800.0)
        return [p.x["v"], (p.u["T"] - drag) / p.x["m"] - 32.174, -p.u["T"] / 1580.9425]

    system = rt.System(["h", "v", "m"], ["T"], rates)
    high, masses = rt.Mayer(lambda a, b: -b.x["h"]), {"m": rt.between(1, 3)}
    thrusts = {"T": rt.between(0, 193.044)}
    return rt.Phase(system, (1, 100), rt.State([0, 0, 3]), rt.State({"m": 1}), high, states=masses, controls=thrusts)


def algal_bacterial() -> rt.Phase:
    """Harvest algae that live with bacteria: Caillau et al., arXiv 2212.03157; test problem of CTDirect."""

    def rates(p: Any) -> list[Any]:
        s, e, v, q, c = (p.x[name] for name in "sevqc")
        share, dilution = p.u["share"], p.u["dilution"]
        growth, uptake, rate = 6.48 * s / (0.09 + s), 27.3e-3 * v / (0.57e-3 + v), 1.0211 * (1 - 2.7628e-3 / q)
        return [
            dilution * (0.5 - s) - growth * e / 0.44,
            ((1 - share) * growth - dilution) * e,
            share * 23e-3 * growth * e - uptake * c - dilution * v,
            uptake - rate * q,
            (rate - dilution) * c,
            dilution * c,
        ]

    system = rt.System([*"sevqc", "yield"], ["share", "dilution"], rates)
    least = {name: rt.between(0, None) for name in "sevc"} | {"q": rt.between(2.7628e-3, None)}
    start = rt.State([0.1629, 0.0487, 0.0003, 0.0177, 0.035, 0])
    inputs = {"share": rt.between(0, 1), "dilution": rt.between(0, 1.5)}
    most = rt.Mayer(lambda a, b: -b.x["yield"])
    return rt.Phase(system, 20.0, start, None, most, states=least, controls=inputs)


def oil_shale() -> rt.Phase:
    """Pyrolysis of oil shale for the most bitumen; the temperature is never near zero, where the rates are no numbers.

    IPOPT finds the same optimum.
    """
    factors, energies = np.exp([8.86, 24.25, 23.67, 18.75, 20.70]), [20300, 37400, 33800, 28200, 31000]

    def rates(p: Any) -> list[Any]:
        k = [f * ca.exp(-e / (1.9872 * p.u["T"])) for f, e in zip(factors.tolist(), energies, strict=True)]
        kerogen, bitumen = p.x["kerogen"], p.x["bitumen"]
        both = kerogen * bitumen
        return [
            -k[0] * kerogen - (k[2] + k[3] + k[4]) * both,
            k[0] * kerogen - k[1] * bitumen + k[2] * both,
            k[1] * bitumen + k[3] * both,
            k[4] * both,
        ]

    system = rt.System(["kerogen", "bitumen", "oil", "carbon"], ["T"], rates, units={"T": "K"})
    most = rt.Mayer(lambda a, b: -b.x["bitumen"])
    heat = {"T": rt.between(698.15, 748.15)}
    return rt.Phase(system, (0.1, 50.0), rt.State([1, 0, 0, 0]), objective=most, controls=heat)


def moon_landing() -> rt.Phase:
    """Land on the moon from 15 km with the least propellant, in SI units; the heaviest that was found is 8380.2 kg."""
    gravity, radius, thrust, exhaust = 4.9028e12, 1737.4e3, 45e3, 311 * 9.80665

    def rates(p: Any) -> list[Any]:
        r, up, along, m = (p.x[name] for name in ("r", "up", "along", "m"))
        push = thrust * p.u["throttle"] / m
        return [
            up,
            along / r,
            along**2 / r - gravity / r**2 + push * ca.sin(p.u["angle"]),
            -up * along / r + push * ca.cos(p.u["angle"]),
            -thrust * p.u["throttle"] / exhaust,
        ]

    system = rt.System(["r", "angle travelled", "up", "along", "m"], ["angle", "throttle"], rates)
    start, end = rt.State([radius + 15e3, 0, 0, 1690.0, 15e3]), rt.State({"r": radius, "up": 0, "along": 0})
    heaviest = rt.Mayer(lambda a, b: -b.x["m"])
    inputs = {"angle": rt.between(-np.pi, 2 * np.pi), "throttle": rt.between(0.1, 1)}
    held = {"m": rt.between(5e3, 15e3), "r": rt.between(radius, radius + 50e3)}
    return rt.Phase(system, (100.0, 2000.0), start, end, heaviest, controls=inputs, states=held)


@pytest.mark.parametrize(
    ("build", "optimum", "accuracy"),
    [(free_flyer, 7.91014874, 1e-4), (hang_glider, -1248.031026, 1e-4), (goddard, -18550.872, 3e-4)],
)
def test_the_published_optimum_follows_from_the_straight_line(
    build: Callable[[], rt.Phase], optimum: float, accuracy: float
) -> None:
    solution = rt.plan(build(), tolerance=1e-4, time_limit=30.0)
    assert solution.objective == pytest.approx(optimum, rel=accuracy)


@pytest.mark.parametrize(
    ("build", "optimum", "accuracy"),
    [
        (free_flyer, 7.91014874, 2e-3),
        (hang_glider, -1248.031026, 2e-3),
        (goddard, -18550.872, 2e-3),
        (oil_shale, -0.35382, 2e-3),
    ],
)
def test_the_default_call_proves_it(build: Callable[[], rt.Phase], optimum: float, accuracy: float) -> None:
    solution = rt.plan(build())
    assert solution.proof is not None and solution.proof.motion_holds
    assert solution.objective == pytest.approx(optimum, rel=accuracy)
    assert rt.validate(solution).passed


@pytest.mark.slow
def test_small_states_are_judged_by_their_own_ranges() -> None:
    # Bacteria feed on 3e-4 of a vitamin: an error of 1e-4, harmless beside 1, is a third of all there is.
    solution = rt.plan(algal_bacterial(), check=False)
    assert solution.objective == pytest.approx(-5.452, rel=2e-3)
    assert solution.proof is not None and solution.proof.error < 1e-3
    assert rt.validate(solution).passed


@pytest.mark.slow
@pytest.mark.parametrize(("duration", "mass"), [(700.0, 8168.612), (1000.0, 8234.899)])
def test_a_moon_landing_is_proved_from_durations_in_which_it_is_possible(duration: float, mass: float) -> None:
    """Two optima, 3 and 2 percent lighter than the best; the first one needs the largest number of intervals."""
    solution = rt.plan(moon_landing(), guess=rt.guess.StraightLine(duration=duration))
    assert solution.proof is not None and solution.proof.motion_holds
    assert solution.objective == pytest.approx(-mass, rel=1e-3)
    assert rt.validate(solution).passed


@pytest.mark.slow
@pytest.mark.parametrize("change", [0.0, 1e-10])
def test_a_moon_landing_is_never_called_infeasible(change: float) -> None:
    """In three times the default duration a lander cannot hover on its least thrust; shorter landings are possible.

    Round-off decides which of its optima is found from there.
    """
    phase = moon_landing()
    start = rt.State([1737.4e3 + 15e3, 0, 0, 1690.0 * (1.0 + change), 15e3])
    solution = rt.plan(phase.with_(start=start), check=False)
    assert solution.status in (Status.SOLVED, Status.NOT_PROVED) and not solution.conflicts
    assert -8381.0 < solution.objective < -6000.0


def test_the_reactor_converges_from_the_straight_line() -> None:
    # CTDirect gives 5.45.
    solution = rt.plan(algal_bacterial(), rt.Mesh(200, rt.HermiteSimpson()), time_limit=30.0)
    assert solution.objective == pytest.approx(-5.45, abs=0.01)


def test_a_standing_robot_cannot_end_a_full_turn_away() -> None:
    """The negated quaternion is the attitude one turn later; four feet on the ground leave no room for a turn."""
    robot = rt.load("solo12", root="floating")
    feet = tuple(name for name in rt.gait.limb_ends(robot) if name.endswith("FOOT"))
    stand = np.array(rt.gait.stand(robot, feet))
    end = stand.copy()
    end[3:7] *= -1.0
    contacts = [rt.PointContact(foot, friction=0.7) for foot in feet]
    ends = rt.State(q=stand, v=0), rt.State(q=end, v=0)
    with pytest.raises(rt.InputError, match="Negate the end quaternion"):
        rt.Phase(robot, 0.5, *ends, rt.Effort(), contacts=contacts)
    # A jump has room for it: no foot is held.
    up = robot.velocity({"root_vz": 0.25 * 9.81})
    rt.Phase(robot, 0.5, rt.State(q=stand, v=up), rt.State(q=end, v=-up), rt.Effort())
