"""The terms that contacts add to a robot's equations, as functions shared by all phases that have the contact.

A contact adds its reaction -J' f, its acceleration, position and velocity, and J' c for the corrections c of these. The
terms of one contact do not depend on other contacts. A foot's terms are therefore one function of the root, its own
leg, its forces and its foothold. This function is differentiated once for all phases of a walk.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from robotraj._util.values import dataclass
from robotraj.dynamics.contact_expressions import ContactExpressions, anchors, pinned, transposed_jacobian_product
from robotraj.dynamics.contacts.base import BoundContact
from robotraj.dynamics.dae import Dynamics
from robotraj.dynamics.point import Point, RobotPoint
from robotraj.dynamics.rigid_body import InverseRigidBody
from robotraj.native.shared_terms import Added, Addend, positions_in
from robotraj.robot.per_robot import PerRobot
from robotraj.robot.robot import Robot


@dataclass(frozen=True, eq=False)
class SymbolicAddend:
    """An addend whose values appear as symbols in the outputs of a stage, each in one row with the factor 1.

    Attributes
    ----------
    symbols : casadi.SX
        (n_s,).
    addend : Addend
    arguments : casadi.SX
        u, expressions of the stage's symbols, (n_u,).
    """

    symbols: ca.SX
    addend: Addend
    arguments: ca.SX

    @property
    def values(self) -> ca.SX:
        """The addend's graph of the arguments, (n_s,)."""
        values: ca.SX = self.addend.function(self.arguments)
        return values


def insert_graphs(y: ca.SX, addends: Sequence[SymbolicAddend]) -> ca.SX:
    """Substitute the addends' graphs for their symbols."""
    if not addends:
        return y
    return ca.substitute(
        y, ca.vertcat(*(each.symbols for each in addends)), ca.vertcat(*(each.values for each in addends))
    )


def extract_addends(y: ca.SX, known: ca.SX, addends: Sequence[SymbolicAddend]) -> tuple[ca.SX, list[Added]]:
    """Return the outputs without the addends, and each addend with the rows to which it is added.

    Parameters
    ----------
    y : casadi.SX
        Outputs of a stage.
    known : casadi.SX
        Unknowns and constants of the stage. The graphs of addends with other arguments remain in y.
    """
    plain, inputs = [], []
    for each in addends:
        places = positions_in(known, each.arguments)
        # Each entry of an addend must appear in exactly one row; otherwise the addend stays in the graph.
        read = np.bincount(ca.jacobian_sparsity(y, each.symbols).get_triplet()[1], minlength=each.symbols.numel())
        if (places >= 0).all() and (read == 1).all():
            plain.append(each)
            inputs.append(places)
    y = insert_graphs(y, [each for each in addends if each not in plain])
    if not plain:
        return y, []
    symbols = ca.vertcat(*(each.symbols for each in plain))
    rows, columns = ca.jacobian(y, symbols).sparsity().get_triplet()
    row_of = np.zeros(symbols.numel(), dtype=np.int64)
    row_of[columns] = rows
    ends = np.cumsum([each.symbols.numel() for each in plain])[:-1]
    own = zip(plain, inputs, np.split(row_of, ends), strict=True)
    added = [Added(each.addend, places, at) for each, places, at in own]
    return ca.substitute(y, symbols, ca.SX.zeros(symbols.numel())), added


@dataclass(frozen=True, eq=False)
class ContactSymbols:
    """The terms of a contact as symbols, with the attributes of a ``ContactExpressions``.

    Attributes
    ----------
    reaction : casadi.SX
    accelerations, places, rates : list of casadi.SX
    corrected : casadi.SX
        Rates (nq + nv,) of the state along the corrections.
    """

    reaction: ca.SX
    accelerations: Sequence[ca.SX]
    places: Sequence[ca.SX]
    rates: Sequence[ca.SX]
    corrected: ca.SX


_ADDENDS: PerRobot[tuple[Addend, list[int]]] = PerRobot()
"""By contact and part: the addend, and the indices in ``_column`` of its arguments."""

PARTS = ("reaction", "accelerations", "places", "rates", "corrected")
"""Parts of the terms of a contact. Each is its own function, since their derivatives have little in common."""


def separate_contact_terms(body: Dynamics, point: Point, c: ca.SX) -> tuple[SymbolicAddend, ...]:
    """Represent the terms of contacts by symbols in every expression built from a point.

    Parameters
    ----------
    body, point
        A phase's dynamics without the variables that objectives added, and its point.
    c : casadi.SX
        Corrections of the invariants.
    """
    if not isinstance(body, InverseRigidBody) or body.design is not None or not isinstance(point, RobotPoint):
        return ()
    kept = PARTS[:-1] if pinned(body.robot, body.contacts) else PARTS
    held = [len(contact.holds) for contact in body.contacts]
    parts: list[SymbolicAddend] = []
    ends = np.cumsum([c.numel() - 2 * sum(held), *held, *held]).tolist()
    for i, (contact, m) in enumerate(zip(body.contacts, held, strict=True)):
        column = _column(contact, point, *(c[ends[k] : ends[k] + m] for k in (i, i + len(held))))
        own = {name: _symbolic_addend(body.robot, contact, name, column) for name in kept}
        symbols = {name: own[name].symbols if name in own else ca.SX(0, 1) for name in PARTS}
        rows = {name: ca.vertsplit(symbols[name]) for name in ("accelerations", "places", "rates")}
        point.contact_terms[contact.name] = ContactSymbols(**(symbols | rows))
        parts += own.values()
    return tuple(parts)


def _symbolic_addend(robot: Robot, contact: BoundContact, name: str, column: ca.SX) -> SymbolicAddend:
    addend, read = _ADDENDS.get(robot, (contact.contact, name), lambda: _build_addend(robot, contact, name))
    return SymbolicAddend(ca.SX.sym(f"{name}.{contact.name}", addend.s.numel()), addend, column[read])


def _build_addend(robot: Robot, contact: BoundContact, name: str) -> tuple[Addend, list[int]]:
    alone, names = InverseRigidBody(robot, None, (contact,)), [anchor.name for anchor in contact.anchors]
    x, z, p = (ca.SX.sym(n, len(g)) for n, g in (("x", alone.states), ("z", alone.algebraic), ("p", names)))
    places, rates = (ca.SX.sym(name, len(contact.holds)) for name in ("places", "rates"))
    point = alone.point(ca.SX.sym("t"), x, z, None, p, names)
    if name == "corrected":
        s = alone.along(point, *(transposed_jacobian_product((contact,), point, part) for part in (places, rates)))
    else:
        part = getattr(ContactExpressions(contact, point), name)
        s = part if isinstance(part, ca.SX) else ca.vertcat(*part)
    column = _column(contact, point, places, rates)
    read = np.flatnonzero(ca.which_depends(s, column, 1, False)).tolist()
    return Addend(column[read], s), read


def _column(contact: BoundContact, point: RobotPoint, places: ca.SX, rates: ca.SX) -> ca.SX:
    """Return the variables that a contact's terms may depend on, as one column."""
    forces = [point.z[force.name] for force in contact.forces]
    return ca.vertcat(point.q, point.v, point.a, *forces, places, rates, *anchors(contact, point.p).values())
