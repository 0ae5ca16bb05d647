"""How things are reached and made, what they lead to, and what operators need before they run."""
