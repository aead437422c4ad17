"""Forward simulation of plans: short parts by themselves, the whole open loop, and the whole with feedback.

Start with ``steps.py``; ``plant.py`` says what moves.
"""
