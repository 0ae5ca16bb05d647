"""Look-ups in a base's file, by what they are about."""
