"""Problems in TOML: what a Python script would state, and messages that name line and key.

Start with ``load.py``.
"""
