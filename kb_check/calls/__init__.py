"""The calls of a script: what they call, with which arguments, and what they give."""
