"""Which names may be meant by one that does not exist: by its spelling, and by words in common."""
