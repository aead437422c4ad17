"""Paths among obstacles as guesses: geometric planners, the times along their paths, and the choice of one."""
