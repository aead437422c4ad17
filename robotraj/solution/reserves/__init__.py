"""What a plan leaves of its cones, soles, torques and speeds to a controller."""
