"""Problems in TOML: what a Python script would state, and messages that name line and key.

Start with ``load.py``. The room may import every room but ``cli``.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
