"""Errors, frozen values, sparse patterns and polynomials: what knows nothing of robots.

Start with ``errors.py``. The room may import nothing else of robotraj.
"""
