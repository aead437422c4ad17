"""Rows that keep shapes apart, and the proof of distances between the collocation points.

Start with ``clearance_rows.py``.
"""
