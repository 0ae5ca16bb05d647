"""The language model behind the roles: asked for a turn, live or from a record, counted and kept within limits."""
