"""Design: masses, lengths, payloads and damping of the robot as parameters of the plan."""

from robotraj._util.forks import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
