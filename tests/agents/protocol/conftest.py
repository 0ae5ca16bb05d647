"""Puts this folder, whose helpers the tests below it share, on the path."""
