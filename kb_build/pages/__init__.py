"""Documentation pages: RST sources through Sphinx, or HTML, to the same records."""
