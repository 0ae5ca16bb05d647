"""What calls are given and return: those of the script's functions, of the API and of Python."""
