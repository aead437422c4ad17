"""Blocks of point functions assembled into the sparse derivatives of a nonlinear program."""
