"""SymbolicModel: one lazily built ``casadi.Function`` per algorithm of rigid bodies."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.errors import InputError, unknown_name
from robotraj._util.lazy_values import cached_property
from robotraj.symbolic.followers import coordinates, in_coordinates
from robotraj.symbolic.joint_tree import graphs_of

if TYPE_CHECKING:
    from robotraj.symbolic._graphs import Graphs

LOCAL_WORLD_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@lru_cache(maxsize=8)
def _compiled_model(text: str, parametric: bool) -> Graphs:
    model = pin.Model()
    model.loadFromString(text)
    return graphs_of(model, parametric)


@lru_cache(maxsize=512)
def _function(text: str, parametric: bool, algorithm: str, *arguments: int) -> ca.Function:
    """Build one function. It is cached per process: a Function is immutable, and equal models share it."""
    return _read(_compiled_model(text, parametric), algorithm, *arguments)


def _read(graphs: Graphs, algorithm: str, *arguments: int) -> ca.Function:
    return ca.Function.deserialize(getattr(graphs, algorithm)(*arguments).decode("latin-1"))


class SymbolicModel:
    """The dynamics and kinematics of one model as ``casadi.Function`` objects with named inputs and outputs.

    Every function is a graph of scalar operations (``SXFunction``), built on first access and kept. The numbers of the
    model are constants of the graph, so multiplications by zero are removed. An input passed as zeros to a call with
    ``SX`` arguments, such as ``fext``, adds no operations to the result either.

    Parameters
    ----------
    model : pinocchio.Model
        Any model, mimic joints included. It is copied; later changes to it have no effect.
    parametric : bool
        When true, every function takes two more inputs at the end, for planning together with design.
        ``inertias`` is 10 x njoints, per joint ``model.inertias[i].toDynamicParameters()``: mass [kg], mass
        times centre [kg m], inertia about the joint's origin Ixx, Ixy, Iyy, Ixz, Iyz, Izz [kg m^2].
        ``translations`` is 3 x njoints, per joint ``model.jointPlacements[i].translation`` [m]. Column 0, the
        universe, is not used. The model's own values are ``model_inertias`` and ``model_translations``.

    Raises
    ------
    InputError
        The model is no ``pinocchio.Model``, or a mimic joint follows one with cosine and sine. If a
        joint is of an unsupported type, such as ``JointModelEllipsoid``, the first access to a function raises.

    Notes
    -----
    Shapes and units: ``q`` nq [rad, m, or cos, sin and quaternions as the joint has them], ``v`` nv [rad/s,
    m/s], ``a`` nv [rad/s^2, m/s^2], ``tau`` nv [N m, N]. ``fext`` is 6 x njoints: wrenches on the joints' bodies
    in the joints' frames, force first [N, N m]. Its column 0, the universe, is not used. Spatial vectors have
    the linear part first. As in Pinocchio, the dynamics include armature, but not damping, friction and rotor inertia.
    A quaternion in ``q`` is (x, y, z, w) and must have length 1.

    Source: Featherstone, Rigid Body Dynamics Algorithms, 2008, on ``casadi::SX``; models are Pinocchio's.

    Examples
    --------
    >>> model = pin.buildSampleModelManipulator()
    >>> symbolic = SymbolicModel(model)
    >>> tau = symbolic.inverse_dynamics(pin.neutral(model), [0.0] * 6, [0.0] * 6, 0)
    """

    def __init__(self, model: pin.Model, *, parametric: bool = False) -> None:
        if not isinstance(model, pin.Model):
            raise InputError(f"model is a {type(model).__name__}; give a pinocchio.Model.")
        coordinates(model)
        self._follows = len(model.mimicking_joints) > 0
        self._known: dict[tuple[str | int, ...], ca.Function] = {}
        self._model = model.copy()
        self._parametric = bool(parametric)

    def __repr__(self) -> str:
        kind = ", parametric=True" if self._parametric else ""
        return f"SymbolicModel({self._model.name!r}, nq={self._model.nq}, nv={self._model.nv}{kind})"

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the model alone; functions are built again on first access.

        Raises
        ------
        InputError
            The model has mimic joints, which Pinocchio 4.1 saves but cannot restore.
        """
        if self._follows:
            raise InputError("Pinocchio 4.1 cannot restore mimic joints; pickle the rt.robot.Robot in place of this.")
        return _restore, (self._model, self._parametric)

    @property
    def model(self) -> pin.Model:
        """A copy of the model the functions were made from."""
        return self._model.copy()

    @cached_property
    def text(self) -> str:
        """Pinocchio's text archive of the model: equal models have equal texts."""
        return str(self._model.saveToString())

    @property
    def parametric(self) -> bool:
        """Whether the functions take ``inertias`` and ``translations`` as inputs."""
        return self._parametric

    @property
    def model_inertias(self) -> npt.NDArray[np.float64]:
        """The model's own value of the input ``inertias``, 10 x njoints (see the class)."""
        return np.column_stack([inertia.toDynamicParameters() for inertia in self._model.inertias])

    @property
    def model_translations(self) -> npt.NDArray[np.float64]:
        """The model's own value of the input ``translations``, 3 x njoints [m]."""
        return np.column_stack([placement.translation for placement in self._model.jointPlacements])

    @property
    def mass(self) -> float:
        """Mass of all bodies that move [kg]."""
        return float(sum(inertia.mass for inertia in list(self._model.inertias)[1:]))

    # -- dynamics -------------------------------------------------------------------------------------------

    @property
    def forward_dynamics(self) -> ca.Function:
        """``(q, v, tau, fext) -> (a)``: the accelerations under joint torques and external wrenches.

        M(q) a = tau - nle(q, v) + sum_i J_i(q)' fext_i, by the articulated-body algorithm (ABA), order nv.
        Of models with mimic joints, M is factorised.
        """
        return self._function("forward_dynamics")

    @property
    def inverse_dynamics(self) -> ca.Function:
        """``(q, v, a, fext) -> (tau)``: the torques that give the accelerations.

        tau = M(q) a + nle(q, v) - sum_i J_i(q)' fext_i, by the recursive Newton-Euler algorithm (RNEA).
        """
        return self._function("inverse_dynamics")

    @property
    def mass_matrix(self) -> ca.Function:
        """``(q) -> (M)``: the joint-space inertia matrix, nv x nv, symmetric and dense, by CRBA."""
        return self._function("mass_matrix")

    @property
    def nonlinear_effects(self) -> ca.Function:
        """``(q, v) -> (nle)``: Coriolis, centrifugal and gravity torques, nv."""
        return self._function("nonlinear_effects")

    @property
    def gravity(self) -> ca.Function:
        """``(q) -> (g)``: the gradient of the potential energy in the tangent space, nv."""
        return self._function("gravity")

    # -- energy, centre of mass, momentum -------------------------------------------------------------------

    @property
    def kinetic_energy(self) -> ca.Function:
        """``(q, v) -> (energy)``: v' M(q) v / 2 [J], armature included."""
        return self._function("kinetic_energy")

    @property
    def potential_energy(self) -> ca.Function:
        """``(q) -> (energy)``: minus the sum of m_i g' c_i(q) [J], zero for centres at the world's origin."""
        return self._function("potential_energy")

    @property
    def center_of_mass(self) -> ca.Function:
        """``(q, v, a) -> (position, velocity, acceleration)`` of the centre of mass, 3 each, in the world."""
        return self._function("center_of_mass")

    @property
    def centroidal_momentum(self) -> ca.Function:
        """``(q, v) -> (h)``: linear and angular momentum about the centre of mass, 6, world axes."""
        return self._function("centroidal_momentum")

    # -- configuration space --------------------------------------------------------------------------------

    @property
    def integrate(self) -> ca.Function:
        """``(q, dv) -> (q1)``: q moved by the tangent vector dv (nv) for unit time."""
        return self._function("integrate")

    @property
    def difference(self) -> ca.Function:
        """``(q0, q1) -> (dv)``: the tangent vector (nv) that takes q0 to q1; the inverse of ``integrate``."""
        return self._function("difference")

    @property
    def configuration_rate(self) -> ca.Function:
        """``(q, v) -> (qdot)``: the time derivative of q, of dimension nq, when the velocity is v.

        qdot = v where a joint's position is a vector; (-s, c) v for (c, s) of a continuous joint; half the
        quaternion product of the orientation with (omega, 0), omega in the body frame.
        """
        return self._function("configuration_rate")

    # -- frames ---------------------------------------------------------------------------------------------

    def frame_placement(self, frame: str) -> ca.Function:
        """``(q) -> (position, rotation)``: where the frame is in the world: 3 [m] and 3 x 3.

        Parameters
        ----------
        frame : str
            Name of a frame of the model.

        Raises
        ------
        UnknownName
            When the model has no frame of that name.
        """
        return self._function("frame_placement", self._frame(frame))

    def frame_velocity(self, frame: str, reference: pin.ReferenceFrame = LOCAL_WORLD_ALIGNED) -> ca.Function:
        """``(q, v) -> (velocity)``: linear [m/s] and angular [rad/s] velocity of the frame, 6.

        Parameters
        ----------
        frame : str
            Name of a frame of the model.
        reference : pinocchio.ReferenceFrame
            Axes to express it in: the world's axes at the frame's origin (the default), or the frame's own.

        Raises
        ------
        UnknownName, InputError
            When the model has no frame of that name, or the reference is no ``pinocchio.ReferenceFrame``.
        """
        return self._function("frame_velocity", self._frame(frame), _reference(reference))

    def frame_acceleration(self, frame: str, reference: pin.ReferenceFrame = LOCAL_WORLD_ALIGNED) -> ca.Function:
        """``(q, v, a) -> (acceleration)``: classical acceleration of the frame, 6 [m/s^2, rad/s^2].

        Classical: the linear part is the second derivative of the origin's position, which the spatial
        acceleration is not (they differ by omega x velocity). Parameters and errors as ``frame_velocity``.
        """
        return self._function("frame_acceleration", self._frame(frame), _reference(reference))

    def frame_jacobian(self, frame: str, reference: pin.ReferenceFrame = LOCAL_WORLD_ALIGNED) -> ca.Function:
        """``(q) -> (J)``: 6 x nv, with velocity = J(q) v. Parameters and errors as ``frame_velocity``."""
        return self._function("frame_jacobian", self._frame(frame), _reference(reference))

    # -- helpers --------------------------------------------------------------------------------------------

    def _function(self, algorithm: str, *arguments: int) -> ca.Function:
        if not self._follows:
            return _function(self.text, self._parametric, algorithm, *arguments)
        key: tuple[str | int, ...] = (algorithm, *arguments)
        if key not in self._known:
            forward = algorithm == "forward_dynamics"
            bias = _read(self._graphs, "inverse_dynamics") if forward else None
            of_all = _read(self._graphs, "mass_matrix" if forward else algorithm, *arguments)
            self._known[key] = in_coordinates(self._model, algorithm, of_all, bias)
        return self._known[key]

    @cached_property
    def _graphs(self) -> Graphs:
        """The graphs of all joints as independent ones."""
        return graphs_of(self._model, self._parametric)

    def _frame(self, name: str) -> int:
        if not isinstance(name, str) or not self._model.existFrame(name):
            raise unknown_name("frame", name, [frame.name for frame in self._model.frames])
        return int(self._model.getFrameId(name))


def _reference(reference: pin.ReferenceFrame) -> int:
    if not isinstance(reference, pin.ReferenceFrame):
        raise InputError(f"reference is {reference!r}; give pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED or .LOCAL.")
    return int(reference)


def _restore(model: pin.Model, parametric: bool) -> SymbolicModel:
    return SymbolicModel(model, parametric=parametric)
