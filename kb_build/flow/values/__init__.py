"""What an expression can be, and what is asked of such types."""
