"""A plan that is watched while it is made: ``rt.plan(..., watch=True)``."""
