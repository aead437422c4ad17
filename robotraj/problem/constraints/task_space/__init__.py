"""Constraints of a tool: directions of its axes, regions and candidates of poses, paths, speeds and accelerations."""
