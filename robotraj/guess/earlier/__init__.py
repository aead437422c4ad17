"""Guesses from several earlier solutions of one kind of problem: their weighted mean."""
