"""Links: values that join the ends of phases."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
