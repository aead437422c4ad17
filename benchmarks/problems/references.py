"""Optima of the cases of more.yaml without collocation, by shooting on Pontryagin's conditions, arc by arc."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import minimize, root

from robotraj._util.arrays import Array


def flow(rates: Callable[..., Any], x: Any, duration: float, **more: Any) -> Any:
    """DOP853 to round-off."""
    return solve_ivp(rates, (0.0, duration), x, "DOP853", rtol=1e-12, atol=1e-13, **more)


def shot(residual: Callable[[Array], Any], guess: Any) -> Array:
    """Root of the boundary conditions."""
    found = root(residual, guess, tol=1e-12, method="lm")
    if np.max(np.abs(residual(found.x))) > 1e-8:
        raise RuntimeError(f"Shooting from {guess} ended with {found.message}")
    return np.asarray(found.x)


def zermelo() -> float:
    """Steer by th' = cos^2 th (the current's shear is 1), from (3.66, -1.86) to the origin."""

    def residual(unknown: Array) -> Any:
        def rates(t: float, x: Array) -> list[float]:
            return [np.cos(x[2]) - x[1], np.sin(x[2]), np.cos(x[2]) ** 2]

        return flow(rates, [3.66, -1.86, unknown[0]], unknown[1]).y[:2, -1]

    return float(shot(residual, [np.radians(105), 5.46])[1])


def goddard() -> float:
    """Full thrust until m g = (1 + v / c) D, along that surface until the fuel is spent, up to the summit."""
    c, d, b = 0.5, 310.0, 500.0

    def rates(u: float, x: Array) -> Array:
        h, v, m = x
        return np.array([v, (u - d * v**2 * np.exp(b * (1 - h))) / m - 1 / h**2, -u / c])

    def surface(x: Array) -> float:
        h, v, m = x
        return float(m / h**2 - (1 + v / c) * d * v**2 * np.exp(b * (1 - h)))

    def slope(x: Array) -> Array:
        h, v, m = x
        air = d * np.exp(b * (1 - h))
        return np.array([-2 * m / h**3 + b * (1 + v / c) * air * v**2, -air * (2 * v + 3 * v**2 / c), 1 / h**2])

    def singular(t: float, x: Array) -> Array:
        # The surface is kept: slope . (rates(0) + u (rates(1) - rates(0))) = 0.
        idle = rates(0.0, x)
        u = -slope(x) @ idle / (slope(x) @ (rates(1.0, x) - idle))
        return rates(float(u), x)

    def arc(f: Any, x: Array, until: Callable[[Array], float]) -> Array:
        def event(t: float, x: Array) -> float:
            return until(x)

        event.terminal = True  # type: ignore[attr-defined]
        return np.asarray(flow(f, x, 1.0, events=event).y[:, -1])

    x = arc(lambda t, x: rates(3.5, x), np.array([1.0, 0.0, 1.0]), surface)
    x = arc(singular, x, lambda x: x[2] - 0.6)
    x = arc(lambda t, x: rates(0.0, x), x, lambda x: x[1])
    return -float(x[0])


def catalyst_mixing() -> float:
    """Solve three arcs: u = 1, a constant mixture, 0; best lengths and mixture."""
    first = np.array([[-1.0, 10.0], [1.0, -10.0]])
    second = np.array([[0.0, 0.0], [0.0, -1.0]])

    def cost(unknown: Array) -> float:
        t1, t2, u = unknown
        x = expm(second * (1 - t2)) @ expm((u * first + (1 - u) * second) * (t2 - t1)) @ expm(first * t1) @ [1.0, 0.0]
        return float(x.sum() - 1)

    options = {"xatol": 1e-10, "fatol": 1e-15, "maxiter": 5000}
    return float(minimize(cost, [0.13, 0.73, 0.23], method="Nelder-Mead", options=options).fun)


def _regulated(pull: Callable[[Array, float], Array], cost: Callable[[Array, float], float],
               steer: Callable[[Array], float], start: Any, duration: float, guess: Any) -> float:  # fmt: skip
    """Cost of x' and lambda' = pull(x, lambda; u), lambda(T) = 0, with u = steer(lambda)."""

    def motion(unknown: Array) -> Any:
        def rates(t: float, y: Array) -> Array:
            u = steer(y)
            return np.append(pull(y, u), cost(y, u))

        return flow(rates, [*start, *unknown, 0.0], duration).y[:, -1]

    return float(motion(shot(lambda unknown: motion(unknown)[2:4], guess))[4])


def van_der_pol() -> float:
    """H = x^2 + v^2 + u^2 + lx v + lv ((1 - x^2) v - x + u), u = -lv / 2."""

    def pull(y: Array, u: float) -> Array:
        x, v, lx, lv = y[:4]
        return np.array([v, (1 - x**2) * v - x + u, -2 * x + lv * (2 * x * v + 1), -2 * v - lx - lv * (1 - x**2)])

    return _regulated(pull, lambda y, u: y[0] ** 2 + y[1] ** 2 + u**2, lambda y: -y[3] / 2, [1, 0], 5.0, [4.87, 0.82])


def rayleigh() -> float:
    """H = x^2 + u^2 + lx v + lv (-x + v (1.4 - 0.14 v^2) + 4 u), u = -2 lv."""

    def pull(y: Array, u: float) -> Array:
        x, v, lx, lv = y[:4]
        acceleration = -x + v * (1.4 - 0.14 * v**2) + 4 * u
        return np.array([v, acceleration, -2 * x + lv, -lx - lv * (1.4 - 0.42 * v**2)])

    guess = [-8.737, -2.581]
    return _regulated(pull, lambda y, u: y[0] ** 2 + u**2, lambda y: -2 * y[3], [-5, -5], 2.5, guess)


def tubular_reactor() -> float:
    """H is stationary where u = l2 / l1 - 1; with l2 = -1 all along and l1(1) = 0, u meets its bound 5 before the end.

    Backwards from the end, in s = 1 - t: the ratio r = -l1 obeys its own equation, so no shooting is needed.
    """

    def control(r: float) -> float:
        return float(min(5.0, 1 / r - 1)) if r > 1 / 6 else 5.0

    def backwards(s: float, y: Array) -> list[float]:
        u = control(y[0])
        return [u - (u + 0.5 * u**2) * y[0]]

    def corner(s: float, y: Array) -> float:
        return float(y[0] - 1 / 6)

    corner.terminal = True  # type: ignore[attr-defined]
    last = flow(backwards, [0.0], 1.0, events=corner)
    rest = flow(backwards, last.y[:, -1], 1.0 - last.t[-1])
    # H = 0 in x1: the yield per unit of x1 to come is r itself.
    return -float(rest.y[0, -1])


def orbit_raising() -> float:
    """Maximise r(T) with u(T) = 0, v(T)^2 r(T) = 1: three costates and a multiplier."""
    thrust, flow_rate, duration = 0.1405, 0.0749, 3.32

    def rates(t: float, y: Array) -> list[float]:
        r, u, v, lr, lu, lv = y
        a, size = thrust / (1 - flow_rate * t), np.hypot(lu, lv)
        return [
            u,
            v**2 / r - 1 / r**2 + a * lu / size,
            -u * v / r + a * lv / size,
            -lu * (-(v**2) / r**2 + 2 / r**3) - lv * u * v / r**2,
            -lr + lv * v / r,
            -lu * 2 * v / r + lv * u / r,
        ]

    def residual(unknown: Array) -> Any:
        lr, lu, lv, nu = unknown
        r, u, v, *ends = flow(rates, [1.0, 0.0, 1.0, lr, lu, lv], duration).y[:, -1]
        return [u, v**2 * r - 1, ends[0] - 1 - nu * v**2, ends[2] - nu * 2 * v * r]

    lr, lu, lv, _ = shot(residual, [1.5, 0.8, 1.6, 0.9])
    return -float(flow(rates, [1.0, 0.0, 1.0, lr, lu, lv], duration).y[0, -1])


REFERENCES: dict[str, Callable[[], float]] = {
    function.__name__: function
    for function in (zermelo, goddard, catalyst_mixing, van_der_pol, rayleigh, tubular_reactor, orbit_raising)
}
