"""What a question asks for by name or in words, beside what answers it best."""
