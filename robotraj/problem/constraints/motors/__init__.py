"""Limits of motors and gears beyond torque and speed: rates, power, curves of torque over speed, payloads."""
