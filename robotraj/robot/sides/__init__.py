"""Left and right of a robot: pairs of joints by their names, and limits that differ between them."""
