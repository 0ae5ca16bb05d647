"""What became of code whose meaning moved, one module each: what it looks for, and what it writes instead."""
