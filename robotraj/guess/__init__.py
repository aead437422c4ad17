"""Initial guesses: arrays, straight lines, keyframes, inverse kinematics, earlier solutions, and walks of legs.

Guesses subclass ``InitialGuess`` in ``problem/initial_guess.py``. Start with ``straight_line.py``.
The room may import ``problem`` and what lies below.
"""

from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
