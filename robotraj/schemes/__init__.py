"""Schemes are values: nodes, weights and the interpolant that was collocated."""

from robotraj.schemes.collocation import Collocation, Scheme
from robotraj.schemes.control import ConstantControl, Control, LinearControl, PolynomialControl
from robotraj.schemes.gauss import GaussLegendre
from robotraj.schemes.lobatto import FifthDegree, HermiteSimpson, LobattoIIIA, Trapezoidal
from robotraj.schemes.mesh import Mesh, MovingMesh
from robotraj.schemes.quadrature import OwnQuadrature, Quadrature, TrapezoidalQuadrature
from robotraj.schemes.radau import RadauIIA

__all__ = [
    "Collocation",
    "ConstantControl",
    "Control",
    "FifthDegree",
    "GaussLegendre",
    "HermiteSimpson",
    "LinearControl",
    "LobattoIIIA",
    "Mesh",
    "MovingMesh",
    "OwnQuadrature",
    "PolynomialControl",
    "Quadrature",
    "RadauIIA",
    "Scheme",
    "Trapezoidal",
    "TrapezoidalQuadrature",
]
