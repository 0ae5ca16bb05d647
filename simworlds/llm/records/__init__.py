"""Records of requests and answers, and how they are played back without a model."""
