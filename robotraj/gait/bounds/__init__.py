"""Bounds of the phases of gaits: attitude of the root, clearance and sides of the feet, and margins."""
