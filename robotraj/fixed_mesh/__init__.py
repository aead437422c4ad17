"""One problem on a fixed mesh: posed, solved from one start or several, limited between its points, or explained.

Start with ``solve.py``. Nothing here changes a mesh to meet an error; ``planning`` does. The room may import every room
below it, and no other reader of a solution.
"""
