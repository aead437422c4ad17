"""Checks along the planned polynomials: limits and constraints, residuals of the equations, energy.

Start with ``violations.py``.
"""
