"""Motion libraries: solutions of neighbouring cases, and plans that start from them. Start with ``library.py``."""
