"""The charts beside the robot: curves of the plan, of the caller, and of the distance to obstacles."""
