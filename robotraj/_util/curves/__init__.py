"""Curves of time: polynomials, splines, piecewise ones, and the teeth of samples."""
