"""What a script's syntax tree shows by itself, whatever Blender's API says."""
