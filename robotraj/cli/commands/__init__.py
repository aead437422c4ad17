"""One file for each command of the shell; ``app.py`` joins them.

A command imports what it needs when it runs, so that ``--help`` and the shell's completion answer at once.
"""
