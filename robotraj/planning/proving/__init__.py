"""Plans whose mesh is refined until their errors between the collocation points meet their goals."""
