"""The answer on a topic: which page a few words mean, what belongs to it, and what is told of it."""
