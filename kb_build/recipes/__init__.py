"""Recipes: how common tasks are done in a few lines, as a base keeps them."""
