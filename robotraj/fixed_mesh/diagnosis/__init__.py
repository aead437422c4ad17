"""Causes of failed plans: ends that motors cannot hold, and limits that conflict with each other."""
