"""robotraj: plan robot motions by direct collocation and prove them by simulation."""

import lazy_loader

from robotraj._util.display import drawings

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

drawings["Solution"] = "robotraj.replay_page.inline:inline"

__version__ = "0.1.0"
