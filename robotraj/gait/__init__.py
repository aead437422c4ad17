"""Gaits: phases and links of robots that walk, run, trot, crawl and jump, written out to plan or to edit.

Start with ``walks.py``. The room may import ``guess``, ``problem`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
