"""Load a Robot's fields from a name, a file or a model."""
