"""Pairs of spheres and obstacles that a phase keeps apart. Start with ``pairs.py``."""
