"""Docstrings of Blender's functions and classes: what they say, and of what."""
