"""Forces of the world and of thrusters on frames of a robot, given among the contacts of a phase.

Start with ``external_force.py``.
"""
