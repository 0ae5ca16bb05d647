"""What one has to know of a few things that neither Blender's API nor its manual says."""
