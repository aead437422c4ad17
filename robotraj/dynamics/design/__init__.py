"""Design: masses, lengths, payloads and damping of the robot as parameters of the plan."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
