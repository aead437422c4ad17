"""Many plans at once: sweeps over problems, many starts of one, and the processes that share the work."""
