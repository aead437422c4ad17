"""Guesses for legged robots: an inverted pendulum, footholds, inverse kinematics and balanced contact forces."""
