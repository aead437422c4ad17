"""URDF files: their XML, the tree, numbers and limits of it, checked before Pinocchio reads the model."""
