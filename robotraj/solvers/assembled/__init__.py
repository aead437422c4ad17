"""Nonlinear programs without stages: every unknown once, every row once, one sparse system a step.

Start with ``program.py``. The folder may import ``stagewise`` and what lies below ``solvers``.
"""
