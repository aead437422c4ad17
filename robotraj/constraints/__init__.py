"""Constraints: small frozen values, each written once and read by transcription, witness and printing."""

from robotraj.lazily import lazily

__getattr__, __dir__, __all__ = lazily(__name__)
