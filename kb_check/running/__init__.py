"""What of a script runs, what it does out of sight, and where it is ready for an error or for None."""
