"""The mode that the active object is in, and what it decides."""
