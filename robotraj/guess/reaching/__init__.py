"""Inverse kinematics: configurations at which frames reach poses, and the order in which a robot takes them."""
