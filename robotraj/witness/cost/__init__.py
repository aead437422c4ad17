"""What a motion costs: its objective by quadrature, and whether a motion nearby costs less.

Start with ``objective.py``.
"""
