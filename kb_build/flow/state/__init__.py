"""What is known where the analysis reads: the files, their definitions, and what each name holds there."""
