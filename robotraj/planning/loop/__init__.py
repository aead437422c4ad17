"""The loop of a plan on several meshes: solve, measure, respond."""
