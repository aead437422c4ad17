"""The sizes of variables and rows in a motion; read ``motion_sizes.py`` first."""
