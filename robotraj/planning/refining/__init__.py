"""Plans whose mesh is refined to a tolerance of their error and their objective."""
