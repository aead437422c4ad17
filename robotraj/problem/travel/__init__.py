"""Ways between both ends of a phase that speeds and accelerations do not allow in its duration."""
