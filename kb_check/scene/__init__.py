"""What a script has surely done to the scene when it comes to a place."""
