"""Single and multiple shooting of a phase: an integrator's end state is the defect."""
