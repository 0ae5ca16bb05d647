"""What is called otherwise than a name says, found by words of names and labels."""
