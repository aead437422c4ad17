"""Many plans at once: sweeps over problems, many starts of one problem, and their worker processes."""
