"""Costs for redundant robots: manipulability, distance from the position limits, variation of speeds."""
