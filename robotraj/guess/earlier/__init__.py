"""Guesses from several earlier solutions."""
