"""Many simulations of a plan under its own gains, with random disturbances."""
