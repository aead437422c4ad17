"""Transcription: a problem on meshes becomes a nonlinear program with named rows.

Start with ``transcribe.py``. The room may import ``problem`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
