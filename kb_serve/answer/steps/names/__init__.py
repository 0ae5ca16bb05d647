"""What steps are about, and what they call it: the names of a topic, the variables of a script."""
