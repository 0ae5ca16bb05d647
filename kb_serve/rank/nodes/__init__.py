"""Which nodes and sockets a question calls by their labels."""
