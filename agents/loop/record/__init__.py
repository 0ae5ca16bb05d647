"""What is kept of a run: the events of its journal, and the state that they lead to."""
