"""What statements do, in the order in which they run, and the bodies of functions."""
