"""Steps that set and call something, on what was made or what is there."""
