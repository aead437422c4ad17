"""Contacts along a line of the foot, about which the foot turns: an edge, and an arc that rolls."""
