"""Mesh files as arrays. Each content is read once, by a process under limits; ``reading.py`` is the place to start."""
