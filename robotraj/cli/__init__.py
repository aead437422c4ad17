"""The shell: ``robotraj demo | plan | validate | replay | ...``, one file a command.

Start with ``app.py``. The room may import every other room.
"""
