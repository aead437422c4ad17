"""The parts of the relaxed problem: rows with slacks, and contacts whose friction has one."""
