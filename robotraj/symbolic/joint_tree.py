"""A Pinocchio model as the tree of joints from which the compiled module builds graphs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from robotraj._util.errors import InputError
from robotraj.symbolic.build import load_graphs
from robotraj.symbolic.followers import axis_of

if TYPE_CHECKING:
    from robotraj.symbolic._graphs import Graphs as Graphs
    from robotraj.symbolic._graphs import JointKind, Tree
else:
    _graphs = load_graphs()
    Graphs, JointKind, Tree = _graphs.Graphs, _graphs.JointKind, _graphs.Tree

_Numbers = npt.NDArray[np.float64]


class _Part(NamedTuple):
    """A joint of a kind that the compiled module supports.

    Attributes
    ----------
    kind : JointKind
    axis : ndarray
        (6,): motion at unit rate, linear part first; zeros where the kind fixes it.
    """

    kind: JointKind
    axis: _Numbers


_NO_AXIS = np.zeros(6)
_KINDS = {
    "JointModelPlanar": JointKind.PLANAR,
    "JointModelSpherical": JointKind.SPHERICAL,
    "JointModelFreeFlyer": JointKind.FREE_FLYER,
}
# Joints that equal a chain of joints about or along these axes.
_CHAINS = {"JointModelSphericalZYX": (5, 4, 3), "JointModelTranslation": (0, 1, 2)}


def graphs_of(model: pin.Model, parametric: bool) -> Graphs:
    """Build the graphs of a model; joints that follow others are independent in them, without armature.

    Parameters
    ----------
    model : pinocchio.Model
    parametric : bool
        Whether inertias and translations are symbols (``SymbolicModel``).

    Raises
    ------
    InputError
        A joint is of an unsupported type.
    """
    armature = [
        model.armature[joint.idx_v : joint.idx_v + joint.nv] if joint.nv else np.zeros(1) for joint in _moving(model)
    ]
    tree = Tree(np.array(model.gravity.linear), np.concatenate([*armature, np.zeros(0)]))
    neutral = pin.neutral(model)
    for i in range(1, model.njoints):
        tree.add_joint(model.parents[i], _placement(model.jointPlacements[i]), _body(model.inertias[i]))
        if model.joints[i].nv:
            _add_parts(tree, model.names[i], model.joints[i], pin.SE3.Identity(), neutral)
        else:
            tree.add_part(JointKind.SCREW, _placement(pin.SE3.Identity()), axis_of(model, i))
    for frame in model.frames:
        tree.add_frame(frame.parentJoint, _placement(frame.placement))
    return Graphs(tree, parametric)


def _moving(model: pin.Model) -> list[pin.JointModel]:
    return [model.joints[i] for i in range(1, model.njoints)]


def _add_parts(tree: Tree, name: str, joint: pin.JointModel, placement: pin.SE3, neutral: _Numbers) -> None:
    """Append a joint, or the joints of which a composite one consists."""
    if joint.shortname() == "JointModelComposite":
        composite = joint.extract()
        for part, where in zip(composite.joints, composite.jointPlacements, strict=True):
            _add_parts(tree, name, part, placement * where, neutral)
            placement = pin.SE3.Identity()
        return
    for part in _parts(name, joint, neutral):
        tree.add_part(part.kind, _placement(placement), part.axis)
        placement = pin.SE3.Identity()


def _parts(name: str, joint: pin.JointModel, neutral: _Numbers) -> list[_Part]:
    kind = joint.shortname()
    if kind in _KINDS:
        return [_Part(_KINDS[kind], _NO_AXIS)]
    if kind in _CHAINS:
        return [_Part(JointKind.SCREW, np.eye(6)[axis]) for axis in _CHAINS[kind]]
    if kind == "JointModelUniversal":
        universal = joint.extract()
        return [_Part(JointKind.SCREW, np.append(np.zeros(3), axis)) for axis in (universal.axis1, universal.axis2)]
    if joint.nv != 1:
        raise InputError(f"Joint {name!r} is a {kind}, whose dynamics are not supported; build it from simpler joints.")
    data = joint.createData()
    joint.calc(data, neutral)
    return [_Part(JointKind.CIRCLE if joint.nq == 2 else JointKind.SCREW, np.array(data.S).reshape(6))]


def _placement(placement: pin.SE3) -> _Numbers:
    return np.column_stack([placement.rotation, placement.translation]).reshape(12)


def _body(body: pin.Inertia) -> _Numbers:
    about_centre = body.inertia
    return np.concatenate([[body.mass], body.lever, about_centre[np.tril_indices(3)]])
