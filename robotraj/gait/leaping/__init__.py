"""Motions from standing to standing with one flight: jumps and flips."""
