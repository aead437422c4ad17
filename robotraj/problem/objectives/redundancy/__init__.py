"""Costs for joints to spare: manipulability, distance from the limits of position."""
