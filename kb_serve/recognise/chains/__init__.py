"""What code says: its expressions and how they hang together, what its variables are likely to be, what it gives and
sets.
"""
