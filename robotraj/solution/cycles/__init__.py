"""Gaits that repeat: the map from one period to the next, and all periods read like one solution."""
