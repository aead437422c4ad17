"""What excludes every motion, whatever the guess and the mesh: momentum, zones to cross, linear programs."""
