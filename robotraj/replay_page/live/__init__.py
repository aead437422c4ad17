"""A plan while it is made: its iterates in a browser of this machine."""
