"""The new scene that steps are done in: what is there, what they have changed, what makes more."""
