"""The indirect view of a direct solution: costates, necessary conditions, Pontryagin's equations.

Its modules are imported one by one: every plan needs the multipliers' mapping and few need more.
"""
