"""What a run works with: its files, its tools, its models and its time."""
