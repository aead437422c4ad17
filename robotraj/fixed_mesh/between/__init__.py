"""Limits between the collocation points of a fixed mesh."""
