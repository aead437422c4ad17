"""Transcription: a problem on meshes becomes a nonlinear program with named rows.

Start with ``transcribe.py``. The room may import ``guess``, ``problem`` and what lies below.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
