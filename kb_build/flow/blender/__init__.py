"""What a Blender has, as types: from its symbols, its docstrings, and facts that these do not tell."""
