"""robotraj: plan robot motions by direct collocation and prove them by simulation."""

from robotraj._util.display import drawings
from robotraj._util.public_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)

drawings["Solution"] = "robotraj.replay_page.inline:inline"

__version__ = "0.1.0"
