"""Schemes are values: nodes, weights and the interpolant that was collocated."""

from .collocation import Collocation, Scheme
from .compressed import CompressedHermiteSimpson
from .control import ConstantControl, Control, LinearControl, PolynomialControl
from .gauss import GaussLegendre
from .integrators import Adaptive, Integrator, RungeKutta4
from .lobatto import FifthDegree, HermiteSimpson, LobattoIIIA, Trapezoidal
from .mesh import Mesh, MovingMesh
from .onestep import OneStep
from .quadrature import OwnQuadrature, Quadrature, TrapezoidalQuadrature
from .radau import RadauIIA
from .shooting import MultipleShooting, Shooting, SingleShooting

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
