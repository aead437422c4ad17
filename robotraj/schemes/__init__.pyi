"""Schemes are values: nodes, weights and the interpolant that was collocated."""

from robotraj.schemes.collocation import Collocation, Scheme
from robotraj.schemes.compressed import CompressedHermiteSimpson
from robotraj.schemes.control import ConstantControl, Control, LinearControl, PolynomialControl
from robotraj.schemes.gauss import GaussLegendre
from robotraj.schemes.integrators import Adaptive, Integrator, RungeKutta4
from robotraj.schemes.lobatto import FifthDegree, HermiteSimpson, LobattoIIIA, Trapezoidal
from robotraj.schemes.mesh import Mesh, MovingMesh
from robotraj.schemes.onestep import OneStep
from robotraj.schemes.quadrature import OwnQuadrature, Quadrature, TrapezoidalQuadrature
from robotraj.schemes.radau import RadauIIA
from robotraj.schemes.shooting import MultipleShooting, Shooting, SingleShooting

__all__ = [
    "Adaptive",
    "Collocation",
    "CompressedHermiteSimpson",
    "ConstantControl",
    "Control",
    "FifthDegree",
    "GaussLegendre",
    "HermiteSimpson",
    "Integrator",
    "LinearControl",
    "LobattoIIIA",
    "Mesh",
    "MovingMesh",
    "MultipleShooting",
    "OneStep",
    "OwnQuadrature",
    "PolynomialControl",
    "Quadrature",
    "RadauIIA",
    "RungeKutta4",
    "Scheme",
    "Shooting",
    "SingleShooting",
    "Trapezoidal",
    "TrapezoidalQuadrature",
]
