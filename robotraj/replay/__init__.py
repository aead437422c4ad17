"""Replay: a solution as one HTML file that opens anywhere, offline."""

from robotraj.replay.write import replay

__all__ = ["replay"]
