"""The simulated model of a phase: its states, their planned values and their rates under the planned controls.

Start with ``plant.py``.
"""
