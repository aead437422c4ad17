"""The ground: height fields that contacts, clearance and replays share."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
