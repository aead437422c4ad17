"""The collocated polynomials of a decision vector."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import basis, integrals, lobatto_sites
from robotraj._util.curves.trajectory import PiecewisePolynomial
from robotraj._util.printing import OneLine
from robotraj._util.values import dataclass
from robotraj.dynamics.rigid_body import RigidBody
from robotraj.transcription.exact_motion import is_exact, with_integrated_speeds
from robotraj.transcription.nlp import Nlp
from robotraj.transcription.schemes.onestep import OneStep


@dataclass(frozen=True, eq=False)
class PhaseTrajectory(OneLine):
    """The polynomials of one phase in global time.

    Attributes
    ----------
    t0, duration : float
        Start time and duration [s].
    x, z, u : PiecewisePolynomial
        State, algebraic variables and controls. Positions of exact motions (``exact_motion``) are integrals of speeds.
    points : ndarray
        Collocation times [s], ascending.
    parameters : dict of str to float
    """

    t0: float
    duration: float
    x: PiecewisePolynomial
    z: PiecewisePolynomial
    u: PiecewisePolynomial
    points: Array
    parameters: dict[str, float]


def extract(nlp: Nlp, w: Array, outputs: Sequence[Array] | None = None) -> tuple[PhaseTrajectory, ...]:
    """Return the polynomials of every phase for a decision vector in physical units.

    Parameters
    ----------
    nlp : Nlp
    w : ndarray (n_w,)
    outputs : sequence of ndarray, optional
        ``nlp.outputs(w)``, if already evaluated.
    """
    blocks = nlp.blocks[: len(nlp.layouts)]
    every = [block.outputs(w) for block in blocks] if outputs is None else outputs[: len(blocks)]
    return tuple(_phase(nlp, i, w, own) for i, own in enumerate(every))


def correction_basis(nodes: Array, tau: Array) -> Array:
    """Return the polynomials of the corrections: 0 at the left knot, each 1 at its node above it; (len(tau), r)."""
    inner = nodes[nodes > 0.0]
    return basis(np.concatenate([[0.0], inner]), tau)[:, 1:]


def _phase(nlp: Nlp, index: int, w: Array, outputs: Array) -> PhaseTrajectory:
    layout = nlp.layouts[index]
    phase = nlp.problem.phases[index]
    t0, duration = layout.t0.of(w), layout.duration.of(w)
    parameters = {name: s.of(w) for name, s in zip(phase.parameter_names, layout.parameters, strict=True)}
    if isinstance(layout.scheme, OneStep):
        from robotraj.transcription.shooting.trajectory import shot_polynomials

        curves = shot_polynomials(phase, layout, outputs, w)
        return PhaseTrajectory(t0, duration, *curves, curves[0].breaks, parameters)
    nx, held = len(phase.dae.states), len(phase.dae.invariants)
    outputs = outputs.T
    rates, corrections = outputs[:, :nx], outputs[:, outputs.shape[1] - held - nx : outputs.shape[1] - held]
    breaks = layout.breaks(w)
    exact = is_exact(phase, layout.mesh.given)
    positions = phase.body.position_count if isinstance(phase.body, RigidBody) else 0
    x_sites: list[Array] = []
    z_sites: list[Array] = []
    u_sites: list[Array] = []
    x_values: list[Array] = []
    z_values: list[Array] = []
    u_values: list[Array] = []
    points = []
    for run in layout.runs:
        nodes, count = run.scheme.nodes, len(run.which)
        sites = lobatto_sites(len(nodes) + 1)
        scaled = run.clock_length[:, None, None] * rates[run.places]
        values = w[run.left][:, None] + integrals(nodes, sites) @ scaled
        if held:
            values += correction_basis(nodes, sites) @ corrections[run.places[:, nodes > 0.0]]
        if exact:
            lengths = breaks[run.which + 1] - breaks[run.which]
            sites, values = with_integrated_speeds(values, lengths, positions)
        x_sites += [sites] * count
        x_values += list(values)
        z_sites += [nodes] * count
        z_values += list(w[run.algebraic])
        u_sites += [run.scheme.control_sites] * count
        u_values += list(w[run.controls])
        first, last = breaks[run.which], breaks[run.which + 1]
        points.append((first[:, None] + (last - first)[:, None] * nodes).ravel())
    return PhaseTrajectory(
        t0,
        duration,
        PiecewisePolynomial(breaks, x_sites, x_values),
        PiecewisePolynomial(breaks, z_sites, z_values),
        PiecewisePolynomial(breaks, u_sites, u_values),
        _ascending(np.concatenate(points)),
        parameters,
    )


def _ascending(times: Array) -> Array:
    """Sort times and remove repeated ones; np.unique would import numpy.ma."""
    times = np.sort(times)
    return times[np.append(True, np.diff(times) > 0.0)]
