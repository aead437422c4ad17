"""The loop of a proved plan: solve, measure, respond."""
