"""Plans that are measured between their points until they are proved."""
