"""Contacts in numbers: motion while they hold, how they hold between knots, and impacts.

Start with ``stance.py``.
"""
