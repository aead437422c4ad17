"""Errors, frozen values, sparse patterns and polynomials: helpers that do not depend on robots.

Start with ``errors.py``. The room may import nothing else of robotraj.
"""
