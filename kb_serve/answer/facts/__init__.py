"""What is told of one symbol in a line or a few: what it is, takes and holds, and what it depends on."""
