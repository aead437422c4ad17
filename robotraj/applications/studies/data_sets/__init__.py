"""Studies as data sets that learning libraries read. Start with ``episodes.py``."""
