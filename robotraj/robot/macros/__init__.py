"""Macros of xacro, which make a URDF: ``expansion.py`` expands a file in a process of its own."""
