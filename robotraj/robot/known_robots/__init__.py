"""Robots that are known by name: those in ``robots/`` and those of example-robot-data."""
