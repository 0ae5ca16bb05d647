"""Steps that make the nodes of a topic, in trees of their own or in those of materials and modifiers."""
