"""Many simulations of a plan under its own gains, with disturbances that the plan does not know."""
