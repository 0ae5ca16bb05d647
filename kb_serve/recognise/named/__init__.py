"""What a name says as it stands: an address, a spelling, a value, what a new thing or a script is called."""
