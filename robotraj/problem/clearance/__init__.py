"""Pairs of spheres and obstacles whose distance a phase bounds. Start with ``pairs.py``."""
