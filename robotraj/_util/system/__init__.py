"""Calls of the operating system: processes, files, limits."""
