"""Solutions in files: one ``.npz`` without pickle, which plain NumPy can open too."""
