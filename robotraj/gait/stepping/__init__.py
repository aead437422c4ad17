"""Steps onto given footholds: walks from rest to rest, sidesteps and turns."""
