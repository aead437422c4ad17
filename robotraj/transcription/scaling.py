"""Automatic scaling: unknowns of order one, rows with gradients of order one.

A variable is scaled by its bounds if both are finite, but by at most ``PLACEHOLDER`` times its guess: limits may be
placeholders far from the motion. Else it is scaled by the guess. All its instances share the scale. Variables
of joints and contacts with the same quantity and unit, in all phases, share the scale of the guess. An acceleration
that is nearly zero in the guess need not stay small, and scales of very different size double the iterations of legged
problems. Variables that are zero in the guess keep SI units.
Durations are scaled by the guess alone. Bounds such as 0 to 200 s do not measure a motion of 6 s. In so large a unit
the first steps reduce the duration to zero. A row is scaled by the largest gradient of its kind at the guess, in scaled
variables. Defects of stiff dynamics are scaled by at most ``STIFF``: a defect is an error of the state, whose size the
gradient does not measure. Source: Betts, Practical Methods for Optimal Control (2010), section 1.16.5.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robotraj._util.arrays import Array
from robotraj._util.sparse import csr_array
from robotraj._util.time_left import LimitReached
from robotraj.transcription.assembly.block import Block
from robotraj.transcription.scalar_table import Entry, Scalars

LEAST, GREATEST = 1e-3, 1e24
"""Range of the sizes of gradients, and size of variables whose guess is a rounding error; friction cones of 1e9 kg are
squares of 1e10 N. The least is relative to the largest variable where all are small, as in motions of micrometres."""
BESIDE = 0.1
"""Distance from the guess at which small gradients of equations are measured again, in scales of the variables."""
PLACEHOLDER = 1e3
"""Bounds above this multiple of the guess are placeholders that do not measure the motion."""
ROUNDING = 1e-10
"""Guesses up to this share of the largest one, or of an SI unit, are rounding errors, and no sizes."""
TIGHT = 1e3
"""Largest bound by which a variable is scaled."""
PLAIN = 1e2
"""Sizes from 1 / PLAIN to PLAIN SI units count as one unit."""
STIFF = 1e2
"""Largest gradient by which a defect is scaled. Solved to 1e-8, it is an error of 1e-6 of the state's scale."""
ALIKE = frozenset({"position", "velocity", "acceleration", "jerk", "effort", "contact force", "contact moment"})
"""Quantities whose variables of one unit share the scale of the guess."""


def variable_scale(variables: Scalars, guess: Array) -> Array:
    """Return the scale of every column, (n_w,)."""
    meaning, low, high = variables.meaning, variables.lower, variables.upper
    entries, count = variables.entries, len(variables.entries)
    both = np.isfinite(low) & np.isfinite(high) & (high > low)
    by_bounds, by_guess = np.zeros(count), np.zeros(count)
    np.maximum.at(by_bounds, meaning[both], np.maximum(np.abs(low[both]), np.abs(high[both])))
    np.maximum.at(by_guess, meaning, np.abs(guess))
    fixed = np.isfinite(low) & (low == high)
    np.maximum.at(by_guess, meaning[fixed], np.abs(low[fixed]))
    by_guess = _shared(entries, by_guess)
    durations = _durations(variables)
    bounded = (by_bounds > 0) & (by_bounds <= TIGHT) & ~durations
    largest = min(1.0, float(by_guess[~durations].max(initial=0.0)))
    noise = (by_guess > 0.0) & (by_guess <= ROUNDING * largest)
    by_guess = np.where(noise, LEAST * largest, by_guess)
    known = np.where((by_guess > 0.0) & ~noise, PLACEHOLDER * by_guess, np.inf)
    size = np.where(bounded, np.minimum(by_bounds, known), by_guess)
    return np.where(size > 0, np.minimum(size, GREATEST), 1.0)[meaning]


def scales(
    blocks: Sequence[Block],
    linear: csr_array,
    variables: Scalars,
    rows: Scalars,
    guess: Array,
    unsized: Sequence[Sequence[NDArray[np.int_]]],
) -> tuple[Array, Array]:
    """Return the scales of the variables and of the rows at the guess, (n_w,) and (n_g,).

    Parameters
    ----------
    unsized : sequence of lists of arrays of int
        Columns that ``rescale_unsized`` may scale, one group after the other.
    """
    scale = variable_scale(variables, guess)
    try:
        for group in unsized:
            columns = np.concatenate([np.zeros(0, dtype=int), *group])
            scale = rescale_unsized(scale, blocks, linear, variables, rows, guess, columns)
        return scale, row_scale(blocks, linear, variables, rows, scale, guess)
    except LimitReached:
        # Without the time for derivatives there is no solve, and the program is only evaluated at its guess.
        return scale, np.ones(len(rows))


def rescale_unsized(
    scale: Array,
    blocks: Sequence[Block],
    linear: csr_array,
    variables: Scalars,
    rows: Scalars,
    guess: Array,
    columns: NDArray[np.int_],
) -> Array:
    """Rescale variables without tight bounds that are zero in the guess, if their size is far from an SI unit, (n_w,).

    Such a variable gets the size at which its terms are as large as the others in some kind of row:

        s_j = 1 / max_i (n_i J_ij / r_i),    r_i = max_k J_ik s_k over the variables k of known size,

    where J_ij is the largest |dg/dw| of row kind i by variable j at the guess. n_i is the number of rows of a kind of
    defect, since a variable acts over the whole phase, and 1 for other kinds. The defect of a state itself is excluded,
    since it compares the change of the state over an interval. A torque that moves 1e-4 kg or 1e8 kg is scaled in this
    way, and so is a speed in a motion of 1e6 s. A size within ``PLAIN`` of the SI unit does not change the scale.

    Parameters
    ----------
    columns : ndarray of int
        Columns of the states of systems, or of controls, impulses and other unknowns of links.
    """
    unsized = ~_sized(variables, guess)
    chosen = np.zeros(len(unsized), dtype=bool)
    chosen[variables.meaning[columns]] = True
    unknown = np.flatnonzero(unsized & chosen)
    if not unknown.size:
        return scale

    def largest(scale: Array) -> Array:
        """Return the largest term of every kind of row."""
        found = np.zeros(len(rows.entries))
        magnitudes = row_magnitudes(blocks, linear, scale, guess)
        np.maximum.at(found, rows.meaning, np.where(np.isfinite(magnitudes), magnitudes, 0.0))
        return found

    defects = np.array([entry.name == "defect" for entry in rows.entries], dtype=bool)
    count = np.where(defects, np.bincount(rows.meaning, minlength=len(defects)), 1)
    others = largest(np.where(unsized[variables.meaning] & (scale == 1.0), 0.0, scale))
    out = scale.copy()
    for kind in unknown:
        own, entry = count * largest(np.where(variables.meaning == kind, 1.0, 0.0)), variables.entries[kind]
        itself = [(row.phase, row.label) == (entry.phase, entry.label) for row in rows.entries]
        compared = (others > 0.0) & (own > 0.0) & ~(defects & itself)
        size = float(1.0 / np.max(own[compared] / others[compared], initial=0.0)) if compared.any() else 1.0
        if not 1.0 / PLAIN <= size <= PLAIN:
            out[variables.meaning == kind] = size
    return out


def _durations(variables: Scalars) -> NDArray[np.bool_]:
    """Return the entries that are durations, (entries,)."""
    return np.array([entry.name == "duration" for entry in variables.entries], dtype=bool)


def _sized(variables: Scalars, guess: Array) -> NDArray[np.bool_]:
    """Return the entries whose size ``variable_scale`` knows from bounds or from the guess, (entries,)."""
    reach = np.maximum(np.abs(variables.lower), np.abs(variables.upper))
    sized = np.zeros(len(variables.entries), dtype=bool)
    np.logical_or.at(sized, variables.meaning, ((reach > 0.0) & (reach <= TIGHT)) | (guess != 0.0))
    return sized


def _shared(entries: Sequence[Entry], sizes: Array) -> Array:
    """Return for each entry that is not zero in the guess the largest size among entries of its quantity and unit."""
    families: dict[tuple[str, str], list[int]] = {}
    for i, entry in enumerate(entries):
        if sizes[i] > 0 and entry.name in ALIKE and entry.unit:
            families.setdefault((entry.name, entry.unit), []).append(i)
    out = sizes.copy()
    for members in families.values():
        out[members] = np.max(sizes[members])
    return out


def row_scale(
    blocks: Sequence[Block], linear: csr_array, variables: Scalars, rows: Scalars, scale: Array, guess: Array
) -> Array:
    """Return the scale of every row, (n_g,), for blocks and a linear part in physical units.

    A gradient may vanish at the guess, which is no size. Inequalities whose gradient is below ``LEAST`` are therefore
    scaled by that, or by their bounds if these are smaller. An equation is solved to its own size, in any unit: a
    gradient below ``LEAST`` is measured ``BESIDE`` the guess, too, and is a size unless it is the round-off of others.
    """

    def largest_at(w: Array) -> Array:
        """Return the largest gradient of every kind of row."""
        magnitudes = row_magnitudes(blocks, linear, scale, w)
        found = np.zeros(len(rows.entries))
        np.maximum.at(found, rows.meaning, np.where(np.isfinite(magnitudes), magnitudes, 0.0))
        return found

    largest = largest_at(guess)
    of_motion = scale[~_durations(variables)[variables.meaning]].max(initial=0.0)
    bounds = np.zeros(len(largest))
    for bound in rows.lower, rows.upper:
        np.maximum.at(bounds, rows.meaning, np.where(np.isfinite(bound), np.abs(bound), 0.0))
    least = np.minimum(LEAST * min(1.0, float(of_motion)), np.where(bounds > 0.0, bounds, np.inf))
    equations = np.ones(len(largest), dtype=bool)
    np.logical_and.at(equations, rows.meaning, rows.lower == rows.upper)
    small = equations & (largest > 0.0) & (largest < least)
    if small.any():
        aside = np.where(np.arange(len(guess)) % 2, BESIDE, -BESIDE) * scale
        largest = np.where(small, np.maximum(largest, largest_at(guess + aside)), largest)
        least[equations & (largest > np.finfo(float).eps * np.median(largest))] = 0.0
    # The linear part of a defect is a difference of states.
    states = np.zeros(len(rows.entries))
    np.maximum.at(states, rows.meaning, _largest(linear, np.abs(linear.data) * scale[linear.indices]))
    stiff = STIFF * np.where(states > 0, states, 1.0)
    greatest = np.where([entry.name == "defect" for entry in rows.entries], stiff, GREATEST)
    return 1.0 / np.clip(np.where(largest > 0, largest, 1.0), least, greatest)[rows.meaning]


def row_magnitudes(blocks: Sequence[Block], linear: csr_array, scale: Array, w: Array) -> Array:
    """Return the largest absolute term of every row of the Jacobian by w / scale at w, (n_g,).

    A term is a product of one entry of S, J and G each. Terms of the same entry of the Jacobian are not added.
    """
    largest = _largest(linear, np.abs(linear.data) * scale[linear.indices])
    for block in blocks:
        if not block.scatter.nnz:
            continue
        stage = block.stage
        rows, columns = stage.jacobian_pattern
        if not rows.size:
            continue
        read = np.flatnonzero(np.bincount(block.scatter.indices // stage.outputs))
        reach = _largest(block.gather, np.abs(block.gather.data) * scale[block.gather.indices])
        reach = reach.reshape(block.count, stage.inputs)[read][:, columns]
        places, constants = block.places(w)[:, read], block.constants[:, read]
        nonzeros = stage.evaluate("jacobian", places, constants).T
        # Expressions that are not defined at the guess are NaN; their rows are not scaled.
        with np.errstate(invalid="ignore"):
            terms = np.where(reach > 0.0, np.abs(nonzeros) * reach, 0.0)
            outputs = np.zeros((block.count, stage.outputs))
            by_row = rows.argsort(kind="stable")
            ranked = rows[by_row]
            first = np.append(0, np.flatnonzero(ranked[1:] > ranked[:-1]) + 1)
            outputs[read[:, None], ranked[first]] = np.maximum.reduceat(terms[:, by_row], first, axis=1)
            values = np.abs(block.scatter.data) * outputs.ravel()[block.scatter.indices]
        largest = np.maximum(largest, _largest(block.scatter, values))
    return largest


def _largest(matrix: csr_array, values: Array) -> Array:
    """Return the largest value of every row, 0 of empty ones; ``values`` replace the nonzeros of the matrix."""
    largest = np.zeros(matrix.shape[0])
    filled = np.diff(matrix.indptr) > 0
    if values.size:
        largest[filled] = np.maximum.reduceat(values, matrix.indptr[:-1][filled])
    return largest
