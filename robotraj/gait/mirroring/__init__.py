"""Reflections of a robot: pairs of names, the mirror link of a gait, and how far the masses are from symmetric."""
