"""How far a robot reaches, and the time that follows from it."""
