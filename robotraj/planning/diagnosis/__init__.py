"""Why a problem has no solution: what its ends need before it is solved, and which limits must give after it failed."""
