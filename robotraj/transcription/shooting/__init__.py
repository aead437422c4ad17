"""Single and multiple shooting of a phase: the defect contains the end state of an integrator."""
