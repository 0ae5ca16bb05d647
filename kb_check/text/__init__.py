"""A script's text: read from its file, cut into what Python can parse, edited, and written back."""
