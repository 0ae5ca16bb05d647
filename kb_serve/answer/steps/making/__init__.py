"""Steps that make things, their parts and the trees of nodes, and put them where they count."""
