"""Forward simulation of plans: short parts, the whole plan open loop, and the whole plan with feedback.

Start with ``steps.py``; ``witness/plants`` holds the simulated models.
"""
