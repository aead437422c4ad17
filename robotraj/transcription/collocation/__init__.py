"""Collocation of a phase: defects, ends, invariants and index reduction."""
