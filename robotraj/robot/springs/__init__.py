"""Springs at joints, which pull towards a position of rest; no URDF has them."""
