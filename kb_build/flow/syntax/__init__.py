"""Scripts as syntax trees, without any types."""
