"""Sizes of a problem along a plain motion, from which settings and starts follow."""
