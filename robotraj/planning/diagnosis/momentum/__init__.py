"""Causes of failures that follow from momentum and gravity alone, whatever the robot's limits and the mesh."""
