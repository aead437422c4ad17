"""Design: numbers of the robot itself (masses, lengths, loads, damping) as parameters of the plan."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
