"""Constraints of a tool: where it may point, regions and candidates of poses, paths, speeds and accelerations."""
