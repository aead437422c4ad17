"""Motions along given paths and through given places: retiming, waypoints without a stop."""
