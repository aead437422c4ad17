"""Single and multiple shooting of a phase."""
