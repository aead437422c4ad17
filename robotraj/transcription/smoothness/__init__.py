"""Smooth controls: the motion that is chosen where a duration leaves joints free, and a measure of what alternates."""
