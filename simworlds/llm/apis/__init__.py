"""The APIs that models are reached by: requests, streamed answers, and asking again."""
