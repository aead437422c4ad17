"""The shell: ``robotraj demo | plan | validate | replay | ...``, one file a command in ``commands/``.

Start with ``app.py``. The room may import every other room.
"""
