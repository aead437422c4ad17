"""Inverse kinematics: configurations at which frames reach poses, and the choice among their branches."""
