"""Problems as frozen values: phases, states, links, constraints, objectives and the rows that they impose.

Start with ``phase.py``. The room may import ``dynamics``, ``robot`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
