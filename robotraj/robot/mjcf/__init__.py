"""MJCF files: models of MuJoCo, read by Pinocchio."""
