"""What an expression is, and what it tells of others where it is a condition."""
