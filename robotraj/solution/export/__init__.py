"""Trajectories as files: tables for spreadsheets and other programs, and what controllers of robots read."""
