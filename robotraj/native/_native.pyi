"""The compiled module. Arrays of many points are flat, point after point: element i of point e has index e n + i."""

from collections.abc import Callable, Mapping, Sequence
from typing import overload

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Narrow = NDArray[np.int32]

PINOCCHIO_VERSION: str
CASADI_VERSION: str

class PointBlock:
    """A function y = f(v, c) at ``count`` points, with its derivatives in v.

    Attributes
    ----------
    count, inputs, constants, outputs : int
        E, n_v, n_c, n_y.
    jacobian_nonzeros, hessian_nonzeros : int
        Numbers a point of dy/dv, and of one triangle of d^2(m' y)/dv^2.
    costed : int
        The output that carries cost, -1 if none does.
    """

    @property
    def count(self) -> int: ...
    @property
    def inputs(self) -> int: ...
    @property
    def constants(self) -> int: ...
    @property
    def outputs(self) -> int: ...
    @property
    def jacobian_nonzeros(self) -> int: ...
    @property
    def hessian_nonzeros(self) -> int: ...
    @property
    def costed(self) -> int: ...
    def values(self, v: Array, c: Array, threads: int = 1) -> Array: ...
    def jacobian(self, v: Array, c: Array, threads: int = 1) -> Array: ...
    def cost(self, v: Array, c: Array, threads: int = 1) -> Array: ...
    def gradient(self, v: Array, c: Array, threads: int = 1) -> Array: ...
    def hessian(self, v: Array, c: Array, m: Array, threads: int = 1) -> Array: ...

def processors() -> list[str]:
    """Kinds of processor whose vectors tapes and inverse dynamics can use here, the fastest first."""

class NotATape(ValueError):
    """A function is no scalar graph of one dense result, or has calls of other functions in it."""

class RigidTree:
    """A tree of joints that turn or slide, on a fixed or a free-flying base.

    Parameters
    ----------
    parents : ndarray
        (n,): the parent of every joint, -1 for the world.
    turns : ndarray
        (n,): 1 where a joint turns about its axis, 0 where it slides along it.
    numbers : ndarray
        (28 n,): of every joint the direction of its axis (3), the rotation (9) and translation (3) of its placement,
        and the mass (1), centre of mass (3) and inertia about it (9) of its body; matrices row after row.
    armature : ndarray
        (n,) [kg m^2, kg].
    gravity : ndarray
        (3,) [m/s^2].
    flies : bool
        Whether joint 0 is a free-flyer.

    Attributes
    ----------
    positions, rates : int
        nq and nv.

    Raises
    ------
    ValueError
        An array has a wrong length, or a joint comes before its parent.
    """

    def __init__(
        self, parents: Indices, turns: Indices, numbers: Array, armature: Array, gravity: Array, flies: bool
    ) -> None: ...
    @property
    def positions(self) -> int: ...
    @property
    def rates(self) -> int: ...
    def jacobian_pattern(self) -> tuple[Indices, Indices]:
        """Rows (of tau) and columns (of x = (q, w, a)) of the numbers of d tau/dx."""
    def hessian_pattern(self) -> tuple[Indices, Indices]:
        """Rows and columns (of x) of the numbers of d^2 (l' tau)/dx^2, one of (i, j) and (j, i)."""

class SphereTree:
    """Spheres on a tree of joints that turn or slide, among convex shapes at rest.

    Parameters
    ----------
    parents : ndarray
        (n,): the parent of every joint, -1 for the world.
    turns : ndarray
        (n,): 1 where a joint turns about its axis, 0 where it slides along it.
    joints : ndarray
        (15 n,): of every joint the direction of its axis (3) and the rotation (9) and translation (3) of its
        placement; matrices row after row.
    groups : ndarray
        (g,): the joint of every group of spheres, -1 for the world.
    group_of : ndarray
        (m,): the group of every sphere, ascending.
    spheres : ndarray
        (4 m,): centre in the joint's frame and radius of every sphere [m].
    pairs : ndarray
        (2 p,): groups that may not touch.
    kinds : ndarray
        (k,): 0 sphere, 1 box, 2 cylinder, 3 capsule, 4 half space, 5 convex mesh.
    shapes : ndarray
        (16 k,): rotation (9), position (3) and dimensions (4) of every shape in the world: radius | half sides |
        radius, half length | normal, offset.
    triangles : ndarray
        (k,): number of triangles of every convex mesh.
    corners : ndarray
        (9 f,): corners of all triangles in their shape's axes, counter-clockwise from outside.

    Raises
    ------
    ValueError
        An array has a wrong length, a joint comes before its parent, or a group is unknown or empty.
    """

    def __init__(
        self,
        parents: Indices,
        turns: Indices,
        joints: Array,
        groups: Indices,
        group_of: Indices,
        spheres: Array,
        pairs: Indices,
        kinds: Indices,
        shapes: Array,
        triangles: Indices,
        corners: Array,
    ) -> None: ...
    def clearances(self, q: Array) -> Array:
        """Return the least signed distance [m] in each of (m,) configurations (m n,)."""
    def distances(self, q: Array, first: Indices, second: Indices, against: int) -> Array:
        """Return the distances (m k,) [m] in (m,) configurations of k pairs.

        The first ``against`` pairs are of a sphere and a shape, the others of two spheres.
        """
    def centres(self, q: Array, spheres: Indices) -> Array:
        """Return the centre (3 m,) [m] of one sphere in each of (m,) configurations."""
    def shortfalls(self, coefficients: Array, counts: Indices, margin: float) -> tuple[Indices, Array]:
        """Prove the distances along polynomials on intervals, or return those that are not proved.

        Parameters
        ----------
        coefficients : ndarray
            Bernstein coefficients of q, one configuration after the other.
        counts : ndarray
            (K,): configurations of each interval.
        margin : float
            Least distance [m].

        Returns
        -------
        ndarray (4 k + 4,)
            Interval, sphere, shape or second sphere, and 1 for two spheres; the last four are of the least distance.
        ndarray (2 k + 2,)
            Place in the interval, in [0, 1], and distance [m].
        """
    def motion_free(self, a: Array, b: Array, margin: float, resolution: float) -> bool:
        """Whether all distances exceed ``margin`` on the straight line; False if one comes within ``resolution``."""
    def connect(
        self,
        start: Array,
        goal: Array,
        lower: Array,
        upper: Array,
        speeds: Array,
        range: float,
        seed: int,
        iterations: int,
        seconds: float,
        shortcuts: int,
        margin: float,
        resolution: float,
    ) -> Array:
        """Return a path (m n,) that RRT-Connect finds, empty where it finds none.

        Joints are weighted by the reciprocals of ``speeds``, in which ``range`` limits one extension. Random parts of
        the path are then replaced by straight lines, of all joints or of one; ``shortcuts`` are tried.
        """

class NearestPlanes:
    """Planes between the nearest shapes of groups of pairs, in configurations whose joints are placed elsewhere.

    Parameters
    ----------
    joints : ndarray
        (m,): the joint of every sphere, 0 for the world.
    spheres : ndarray
        (4 m,): as of ``SphereTree``.
    kinds, shapes, triangles, corners : ndarray
        As of ``SphereTree``.
    first, second : ndarray
        (p,): the sphere of every pair, and its shape or second sphere; group after group.
    groups : ndarray
        (4 g,): of every group the end of its pairs, the number of planes, 1 where second shapes are spheres, and the
        joint that carries both shapes, 0 for the world.
    rotations : ndarray
        (9 g,): rotation of that joint at which normals are returned, row after row.

    Raises
    ------
    ValueError
        An array has a wrong length, a group has too few pairs, or a shape or a joint is unknown.
    """

    def __init__(
        self,
        joints: Indices,
        spheres: Array,
        kinds: Indices,
        shapes: Array,
        triangles: Indices,
        corners: Array,
        first: Indices,
        second: Indices,
        groups: Indices,
        rotations: Array,
    ) -> None: ...
    def find(self, places: Array, poses: Array, count: int) -> tuple[Array, Indices, Array]:
        """Return distances [m], nearest pairs and planes.

        Parameters
        ----------
        places : ndarray
            (12 j count,): rotation, row after row, and position of every joint in each configuration, the world first.
        poses : ndarray
            (12 k count,): the same of every shape.
        count : int
            Number of configurations.

        Returns
        -------
        ndarray (p,)
            Distances of all pairs in the first configuration [m].
        ndarray (r count,)
            The nearest pairs of every group, the nearest first, configuration after configuration.
        ndarray (4 r count,)
            Their normals and offsets [m].
        """

class Tape:
    """A scalar graph as a list of instructions.

    Attributes
    ----------
    outputs : int
        Numbers in the result.
    """

    @property
    def outputs(self) -> int: ...

Pattern = tuple[Indices, Indices]

class StageGraph:
    """A stage function y = psi(v, c, r), where r = RNEA(x) with x = chi(v, c), and its derivatives.

    Patterns are rows and columns of nonzeros, column after column. An entry is a nonzero where its graph is not zero,
    so a pattern may have fewer entries than CasADi's. Without torques, r and x are empty, and tapes take (v, c) alone
    instead of (v, c, r).

    Parameters
    ----------
    text : str
        ``Function.serialize()`` of (v, c, r) -> y, x, columns.

    Attributes
    ----------
    inputs, constants, torques, outputs, arguments : int
        n_v, n_c, n_r, n_y, n_x.

    Raises
    ------
    NotATape
        A tape is requested and the function calls other functions.
    """

    def __init__(self, text: str) -> None: ...
    @property
    def inputs(self) -> int: ...
    @property
    def constants(self) -> int: ...
    @property
    def torques(self) -> int: ...
    @property
    def outputs(self) -> int: ...
    @property
    def arguments(self) -> int: ...
    def values(self) -> Tape: ...
    def slopes(self) -> tuple[Tape, Pattern, Pattern]:
        """Nonzeros of dy/dv, then of dy/dr."""
    def gradient(self) -> Tape:
        """Return dy/dv of the only output as a dense column, for stages without torques."""
    def curvature(self) -> tuple[Tape, Tape | None, Pattern, Pattern, Pattern]:
        """With l = d(m' y)/dr: l, then nonzeros of the lower triangle of d^2(m' y)/dv^2, dl/dv and dl/dr.

        The second tape has the same results without the negative curvature of saturations t = tanh(z): each adds
        k dz/du dz/du' to the Hessian by u = (v, r), and k is at least zero there. None without saturations.
        """
    def places(self) -> Indices | None:
        """Return the index in v of every entry of x, -1 for zeros; None where one is another expression."""
    def chain(self) -> tuple[Tape, Tape, Pattern, Pattern]:
        """Return (v, c) -> x, dx/dv, and (v, c, g) -> lower triangle of sum_i g_i d^2 x_i/dv^2; then their patterns."""
    def selected(self, outputs: Indices) -> StageGraph:
        """Return the graph with some of its outputs."""
    def split(self) -> tuple[Indices, Tape, Pattern]:
        """Return the outputs that are not affine in v, and of the others, A(c) v + b(c), nonzeros of A, then b.

        The tape takes no v and c; the pattern is that of A.
        Torques and results of other functions that are called count as functions of v.
        """
    def constant_slopes(self) -> Array:
        """dy/dv, column after column: numbers where it is constant, NaN where it is not."""

class Torques:
    """Inverse dynamics tau = RNEA(q, w, a), x = (q, w, a).

    Parameters
    ----------
    robot : RigidTree
    places : ndarray of int
        The index in v of every entry of x, -1 where it is zero. Or else
    arguments, curvature : Tape
        (v, c) -> x, then the nonzeros of dx/dv, and (v, c, g) -> nonzeros of sum_i g_i d^2 x_i/dv^2.
    """

    @overload
    def __init__(self, robot: RigidTree, places: Indices) -> None: ...
    @overload
    def __init__(self, robot: RigidTree, arguments: Tape, curvature: Tape) -> None: ...

class Call:
    """A tape that several blocks share, with the indices of its arguments in one of them.

    Parameters
    ----------
    tape : Tape
        Of a stage graph without constants: u -> numbers or, called by a recipe of the Hessian, (u, l) -> numbers.
    inputs : ndarray of int
        The index in (v, c) of every entry of u.
    multipliers : ndarray of int
        The index in m of every entry of l; empty except for the Hessian.
    """

    def __init__(self, tape: Tape, inputs: Indices, multipliers: Indices) -> None: ...

class Recipe:
    """How one result of a point is computed, in a buffer of parts, each there where the recipe or the torques have it.

    1 | tape | d tau/dx | d^2 (l' tau)/dx^2 | (x, dx/dv) | sum_i g_i d^2 x_i/dv^2 | calls | made,    g = (d tau/dx)' l

    Parameters
    ----------
    tape : Tape
        Of (v, c), then tau where the block has torques, then m where it is the Hessian's.
    jacobian, hessian : bool
        Whether the buffer has these parts. Of the Hessian, l is what the tape gives first.
    made : int
        Length of the last part, which the products fill: buffer[out] += buffer[left] * buffer[right], in order.
    result, results : int
        The piece of the buffer that is the result.
    calls : list of Call
        Their results follow each other in the buffer.
    """

    def __init__(
        self,
        tape: Tape,
        jacobian: bool,
        hessian: bool,
        made: int,
        result: int,
        results: int,
        out: Indices,
        left: Indices,
        right: Indices,
        calls: list[Call] = ...,
    ) -> None: ...

class TapeBlock(PointBlock):
    """A block of tapes, and a robot's inverse dynamics where it has any.

    Parameters
    ----------
    convex : Recipe, optional
        The Hessian without the negative curvature of saturations, with the results of ``hessian``.
    processor : str
        One of ``processors()``; the fastest by default.

    Raises
    ------
    ValueError
        Sizes or places that do not fit each other.
    """

    def __init__(
        self,
        count: int,
        inputs: int,
        constants: int,
        values: Recipe,
        jacobian: Recipe | None = None,
        hessian: Recipe | None = None,
        convex: Recipe | None = None,
        cost: Recipe | None = None,
        gradient: Recipe | None = None,
        costed: int = -1,
        torques: Torques | None = None,
        processor: str = "",
    ) -> None: ...

class CasadiBlock(PointBlock):
    """A block over CasADi functions.

    Parameters
    ----------
    count, inputs, constants, outputs : int
        E, n_v, n_c, n_y.
    functions : mapping of str to (bytes, int)
        ``Function.serialize()`` as latin-1, and the points L that a call takes, under "values", "jacobian", "cost",
        "gradient" and "hessian": (v (n_v, L), c (n_c, L)) -> (n, L), the last one with m (n_y, L) as well.
    jacobian, hessian : int
        Nonzeros a point; 0 where there is no such function.
    costed : int
        The output that carries cost, -1 if none does.

    Raises
    ------
    ValueError
        Where a function is missing or has another shape.
    """

    def __init__(
        self,
        count: int,
        inputs: int,
        constants: int,
        outputs: int,
        functions: Mapping[str, tuple[bytes, int]],
        jacobian: int = 0,
        hessian: int = 0,
        costed: int = -1,
    ) -> None: ...

class Csr:
    """A sparse matrix in compressed rows, never changed; ``starts`` and ``indices`` of 32 or 64 bits.

    ``summed`` adds up entries (row[i], column[i]); it and products have ascending columns in every row. ``pruned``
    drops entries that are exactly zero. ``resolved`` gives X of X = E + C X, the square matrix being C and row i
    of E the unit vector ``variable[i]``, or zero where that is negative.
    """

    def __init__(self, rows: int, columns: int, starts: Indices, indices: Indices, data: Array) -> None: ...
    @staticmethod
    def summed(rows: int, columns: int, row: Indices, column: Indices, data: Array) -> Csr: ...
    @overload
    def __matmul__(self, x: Array) -> Array: ...
    @overload
    def __matmul__(self, other: Csr) -> Csr: ...
    def resolved(self, variable: Indices, columns: int) -> Csr: ...
    def pruned(self) -> Csr: ...
    def transposed(self) -> Csr: ...
    @property
    def starts(self) -> NDArray[np.int32]: ...
    @property
    def indices(self) -> NDArray[np.int32]: ...
    @property
    def data(self) -> Array: ...
    @property
    def rows(self) -> int: ...
    @property
    def columns(self) -> int: ...
    @property
    def entries(self) -> int: ...

class Stacked:
    """A sparse matrix of blocks of rows, of which those that come again, a fixed number of columns on, are kept once.

    ``entries`` counts them all, ``kept`` those that are there. A Csr is taken wherever one of these is.
    """

    def __init__(self, matrix: Csr) -> None: ...
    def __matmul__(self, x: Array) -> Array: ...
    @property
    def rows(self) -> int: ...
    @property
    def columns(self) -> int: ...
    @property
    def entries(self) -> int: ...
    @property
    def kept(self) -> int: ...

class Chain:
    """Places of a block for the chain rule, Y_e = f(v_e): patterns of one place, and where v comes from and Y goes.

    Parameters
    ----------
    count, inputs, outputs : int
        E, n_v, n_y.
    jacobian_rows, jacobian_columns, hessian_rows, hessian_columns : ndarray of int
        Nonzeros of dy/dv, and of one triangle of d^2(m' y)/dv^2.
    scatter : Csr (rows, n_y E)
    reads : Csr (n_v E, columns of the problem)
        What v is, before columns have their stages.
    gather : Csr (n_v E, columns of y)
        The same, read in the stage of the place.
    stages : ndarray of int (E,)

    Raises
    ------
    ValueError
        Where these do not fit each other.
    """

    def __init__(
        self,
        count: int,
        inputs: int,
        outputs: int,
        jacobian_rows: Indices,
        jacobian_columns: Indices,
        hessian_rows: Indices,
        hessian_columns: Indices,
        scatter: Csr,
        reads: Csr,
        gather: Csr,
        stages: Indices,
    ) -> None: ...

def jacobian_chain(
    linear: Csr, chains: Sequence[Chain], expressions: Csr, base: Indices, starts: Indices, stages: Indices
) -> tuple[tuple[Narrow, Narrow], Array, list[Csr]]:
    """Entries (rows, columns) of linear + sum_b S_b blkdiag(J_e) G_b in row-major order, and what they are made of.

    Parameters
    ----------
    linear : Csr (rows, columns)
    chains : sequence of Chain
    expressions : Csr (slots, columns)
        Column c of the problem, seen in stage s, is its row base[c] + s.
    base : ndarray of int (columns of the problem,)
    starts : ndarray of int (stages + 1,)
        First column of every stage.
    stages : ndarray of int (rows,)
        In which every row reads.

    Returns
    -------
    (rows, columns), constants, parts
        entries = constants + sum_b parts[b] vec(J_b).
    """

def hessian_chain(chains: Sequence[Chain], starts: Indices) -> tuple[tuple[Narrow, Narrow], Array, list[Stacked]]:
    """Entries of the upper triangle of sum_b G_b' blkdiag(H_e) G_b; as ``jacobian_chain``, without constants.

    Stages that read alike have the same rows, which are kept once.
    """

class Term:
    """A block in a program: v = gather y + gather_offset, rows += scatter vec(Y), objective += weights' Y[costed].

    Parameters
    ----------
    block : PointBlock
        Evaluated by one program at a time.
    gather : Csr (n_v E, columns)
    gather_offset : ndarray (n_v E,)
    constants : ndarray (n_c E,)
    scatter : Csr (rows, n_y E) or None
        None where the block has no rows.
    weights : ndarray (E,) or None
        None where it has no cost.
    gradient : Csr (columns, n_v E) or None
        gradient += gradient vec(grad Y[costed]), the weights in it.
    jacobian : Csr (entries, nonzeros E) or None
    hessian : Stacked or Csr (entries, nonzeros E) or None
        What the nonzeros of the block add to the entries of the program's Jacobian and Hessian.
    """

    def __init__(
        self,
        block: PointBlock,
        gather: Csr,
        gather_offset: Array,
        constants: Array,
        scatter: Csr | None = None,
        weights: Array | None = None,
        gradient: Csr | None = None,
        jacobian: Csr | None = None,
        hessian: Stacked | Csr | None = None,
    ) -> None: ...

class Outcome:
    """What a solve ended with.

    Attributes
    ----------
    y : ndarray (columns,)
        The last iterate, also where the solve was stopped.
    lam : ndarray (rows,)
        Multipliers: gradient + Jacobian' lam = 0 at a solution. Positive at an active upper bound.
    lower_duals, upper_duals : ndarray (inequality rows,)
        Multipliers of the bounds, not negative; lam of the inequality rows is upper_duals - lower_duals.
    status : str
        "solved", "acceptable", "settled" (by ``objective_change``), "iteration limit", "infeasible",
        "line search failed", "step failed", "time limit", "interrupted" (Ctrl-C), "stopped" (by the callback) or
        "failed" (then ``message`` is that of the exception).
    iterations : int
    objective, violation : float
        At y; the largest violated row, bounds of inequality rows included.
    mu : float
        Last barrier parameter.
    times : dict
        Seconds in "functions" (of the blocks), "combinations" (sparse products), "linear algebra" (steps) and
        in "total".
    trace : list of (objective, infeasibility, dual infeasibility, mu)
        One line an iteration; in the restoration phase the barrier parameter is its own.
    """

    @property
    def y(self) -> Array: ...
    @property
    def lam(self) -> Array: ...
    @property
    def lower_duals(self) -> Array: ...
    @property
    def upper_duals(self) -> Array: ...
    @property
    def status(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def iterations(self) -> int: ...
    @property
    def objective(self) -> float: ...
    @property
    def violation(self) -> float: ...
    @property
    def mu(self) -> float: ...
    @property
    def times(self) -> dict[str, float]: ...
    @property
    def trace(self) -> list[list[float]]: ...

class SymmetricFactors:
    """L D L' of a sparse symmetric indefinite matrix, which factorises Newton systems without stages.

    Multifrontal (Duff and Reid 1983), in an order of approximate minimum degree, with pivots of one or two rows that
    keep multipliers below 1 / threshold; rows are scaled first.

    Parameters
    ----------
    starts, rows : int64 arrays of shape (n + 1,) and (entries,)
        The lower triangle by columns, as in SciPy's CSC.
    processor : str
        One of ``processors()``; the fastest by default.
    groups : sequence of int (k n,)
        Rows are eliminated by ascending group, within a group by approximate minimum degree. Of k numbers for each row
        those are chosen that take fewest products.

    Raises
    ------
    ValueError
        When an entry is above the diagonal.
    """

    def __init__(self, starts: Indices, rows: Indices, processor: str = "", groups: Sequence[int] = ()) -> None: ...
    def factorise(self, values: Array, threshold: float = 1e-8, small: float = 1e-20) -> tuple[int, int, int]:
        """Return the numbers of negative and of zero pivots, and of delayed pivots."""
    def solve(self, b: Array) -> Array: ...
    @property
    def products(self) -> int:
        """Operations of a factorisation without delayed pivots; a multiplication and an addition count as two."""
    @property
    def largest_front(self) -> int: ...

class Options:
    """Options of a solve, by name; what is not named keeps its default. See ``interior_point/problem/options.hpp``.

    Raises
    ------
    ValueError
        For a name that is no option or a value of another type.
    """

    tolerance: float
    acceptable_tolerance: float
    acceptable_iterations: int
    violation_tolerance: float
    objective_change: float
    max_iterations: int
    processor_limit: float
    initial_barrier: float
    barrier_factor: float
    barrier_decrease: float
    barrier_power: float
    adaptive_barrier: bool
    bound_relaxation: float
    bound_push: float
    bound_fraction: float
    elimination_tolerance: float
    pivot_tolerance: float
    first_correction: float
    correction_increase: float
    correction_decrease: float
    row_correction: float
    least_row_correction: float

    def __init__(self, **options: float) -> None: ...

class Program:
    """A stagewise program and the solver that is kept for it.

        minimise cost' y + cost_offset + sum_b weights_b' Y_b[costed]
        subject to rows = linear y + offset + sum_b scatter_b vec(Y_b)

    with columns (u_0, x_0, u_1, x_1, ...) and rows [dynamics, path equalities, inequalities], each stage after stage.
    Dynamics are -x_{k+1} + F(x_k, u_k) = 0 and path equalities are 0; inequalities have the bounds given to ``solve``.

    Parameters
    ----------
    controls, states, equalities, inequalities : ndarray of int (K,)
        Sizes of every stage.
    linear : Csr (rows, columns)
    offset : ndarray (rows,)
    cost : ndarray (columns,)
    cost_offset : float
    jacobian_rows, jacobian_columns : ndarray of int
        Entries of the Jacobian, in any order, each once; a dynamics row's -1 is optional.
    jacobian_constants : ndarray
        Their constant parts, those of ``linear`` included.
    hessian_rows, hessian_columns : ndarray of int
        Entries of one triangle of the Hessian, each inside one stage.
    terms : sequence of Term
    threads : int
        Evaluate the blocks. The bits of the answer do not depend on it.
    groups : ndarray of int32 (k (columns + rows),), optional
        k numbers of columns and rows, one after the other. A sparse factorisation eliminates them in groups by
        ascending number, by those numbers that take fewest products.

    Raises
    ------
    ValueError
        Where shapes do not fit or an entry joins two stages.
    """

    def __init__(
        self,
        controls: Indices,
        states: Indices,
        equalities: Indices,
        inequalities: Indices,
        linear: Csr,
        offset: Array,
        cost: Array,
        cost_offset: float,
        jacobian_rows: Indices,
        jacobian_columns: Indices,
        jacobian_constants: Array,
        hessian_rows: Indices,
        hessian_columns: Indices,
        terms: Sequence[Term],
        threads: int = 1,
        groups: NDArray[np.int32] | None = None,
    ) -> None: ...
    @property
    def iterate(self) -> Array:
        """The last iterate, (columns,); of the solve under way where its callback reads it."""
    @property
    def threads(self) -> int: ...
    def solve(
        self,
        y: Array,
        lower: Array,
        upper: Array,
        options: Options = ...,
        *,
        lam: Array | None = None,
        lower_duals: Array | None = None,
        upper_duals: Array | None = None,
        objective_scale: float = 1.0,
        callback: Callable[[int, float, float], bool | None] | None = None,
        time_limit: float = ...,
    ) -> Outcome:
        """Solve from y.

        Parameters
        ----------
        y : ndarray (columns,)
        lower, upper : ndarray (inequality rows,)
            Infinite where there is no bound.
        options : Options
        lam, lower_duals, upper_duals : ndarray or None
            A warm start, as in ``Outcome``. Without ``lam`` it is estimated, from the other two where they are given.
            Without the other two they are the parts of ``lam``.
        objective_scale : float
            What the objective is multiplied by; multipliers are of the objective as it is.
        callback : callable (iteration, objective, infeasibility) -> bool
            Asked once an iteration; stops where it gives True. What it raises is raised here.
        time_limit : float
            Seconds.

        Raises
        ------
        RuntimeError
            While it is being solved already, by another thread or around a callback.
        """
    def set_offsets(self, offset: Array, cost_offset: float) -> None:
        """Replace the constant parts of the rows and of the objective."""
    def set_block_offsets(self, block: int, offset: Array) -> None:
        """Replace a term's ``gather_offset``."""
    def set_constants(self, block: int, constants: Array) -> None:
        """Replace a term's ``constants``."""
    def rows(self, y: Array) -> Array:
        """Values of the rows."""
    def objective(self, y: Array) -> float:
        """Value of the objective."""
    def gradient(self, y: Array) -> Array:
        """Gradient of the objective."""
    def jacobian(self, y: Array) -> Array:
        """Values of the Jacobian's entries, in the order they were given."""
    def hessian(self, y: Array, lam: Array, lam_f: float = 1.0) -> Array:
        """Values of the Hessian's entries of lam_f objective + lam' rows."""
