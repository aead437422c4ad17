"""Replay: a solution as one HTML file that opens anywhere, offline."""
