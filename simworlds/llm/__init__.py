"""Language models: live or played back from a record, metered, and within limits of cost and context."""
