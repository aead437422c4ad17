"""Claims about a plan, and those that the planner's own measures show.

Start with ``claim.py``.
"""
