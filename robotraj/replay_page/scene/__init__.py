"""The three-dimensional scene of a page: links, meshes, ground, markers and their motion."""
