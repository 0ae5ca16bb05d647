"""How an attempt is judged: by the verifier, by the reviewer, and by what its plan wanted."""
