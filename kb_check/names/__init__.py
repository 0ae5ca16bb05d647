"""Names that this Blender lacks: what is known of them, what is meant, and what else their use needs."""
