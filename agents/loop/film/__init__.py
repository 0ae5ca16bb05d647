"""The last stage: how much time a film has, what it will look like, and the rendering itself."""
