"""The command ``simworlds check``: which files, what is wanted of them, what was checked before, and the report."""
