"""From a name, a file or a model to what a Robot is made of. Layer 0."""
