"""Answers from many plans: designs by gradients, and fronts of two objectives. Start with ``codesign.py``."""
