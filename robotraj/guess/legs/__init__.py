"""Guesses for robots with legs: an inverted pendulum, footsteps, balanced forces."""
