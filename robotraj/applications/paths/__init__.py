"""Motions along given paths and through given waypoints."""
