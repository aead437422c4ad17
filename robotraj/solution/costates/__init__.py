"""Costates from the multipliers of a nonlinear program, and back."""
