"""What a class lacks and something else near it has: its parts, what holds it, data of another type."""
