"""The problems of ``robotraj demo``; ``table.py`` lists them by name."""
