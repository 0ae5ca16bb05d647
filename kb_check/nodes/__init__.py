"""The nodes of a script: their settings, their trees, and the sockets that they have and show."""
