"""The contribution to the objective of controls that a mesh does not resolve.

On an interval the controls are u = sum_i c_i P_i with Legendre polynomials P_i. Where a control bends sharply, the
coefficient of the highest degree d is not small. Half the second difference of the integrand l in that direction,

    integral of (l(u + c_d P_d) - 2 l(u) + l(u - c_d P_d)) / 2 dt,

is h |c_d|^2 / (2 d + 1) for l = |u|^2, the contribution of the highest degree to the effort.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotraj._util.arrays import Array
from robotraj._util.curves.polynomials import gauss, legendre_sum
from robotraj.problem.phase import Phase
from robotraj.transcription.driven_motion import Inputs
from robotraj.transcription.extract import PhaseTrajectory
from robotraj.transcription.refinement.objective_quadrature import MORE, rate_of
from robotraj.transcription.schemes.collocation import Collocation, Scheme


def unresolved(phase: Phase, trajectory: PhaseTrajectory, schemes: Sequence[Scheme], inputs: Inputs) -> Array:
    """Return the contribution of the controls' highest degree to the objective on every interval, in its unit, (K,)."""
    found = np.zeros(len(schemes))
    rate = rate_of(phase)
    if rate is None:
        return found
    breaks = trajectory.x.breaks
    for scheme in dict.fromkeys(schemes):
        if not isinstance(scheme, Collocation):
            continue
        which = np.array([k for k, own in enumerate(schemes) if own == scheme])
        degree = len(scheme.control_sites) - 1
        points, weights = gauss(len(scheme.nodes) + MORE)
        places = 0.5 * (points + 1.0)
        highest = legendre_sum(points, np.append(np.zeros(degree), 1.0))
        x = trajectory.x.inside(places)[which]
        z, u = (each[which] for each in inputs.inside(places))
        top = np.einsum("m,kmj->kj", (degree + 0.5) * weights * highest, u)[:, None] * highest[:, None]
        lengths = np.diff(breaks)[which]
        times = breaks[which][:, None] + lengths[:, None] * places
        count = times.size
        parameters = np.tile(np.array(list(trajectory.parameters.values()), dtype=float)[:, None], count)

        fixed = (times.reshape(1, -1), x.reshape(count, -1).T, z.reshape(count, -1).T)
        more, less, own = (
            np.array(rate.map(count)(*fixed, controls.reshape(count, -1).T, parameters)).reshape(times.shape)
            for controls in (u + top, u - top, u)
        )
        found[which] = 0.25 * lengths * ((more - 2.0 * own + less) @ weights)
    return np.maximum(found, 0.0)
