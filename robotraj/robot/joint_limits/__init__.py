"""Limits of joints as users give them, and what is wrong with them."""
