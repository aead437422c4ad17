"""Reflections of a robot: pairs of names, the mirror link of a gait, and a measure of the asymmetry of the inertia."""
