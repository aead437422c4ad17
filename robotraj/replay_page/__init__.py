"""A solution as one HTML file that opens anywhere, offline.

Start with ``write.py``. The room reads solutions: it may import ``solution``, ``problem`` and what lies below, but
neither ``transcription`` nor ``solvers``.
"""
