"""What is said about a motion: its sentence, its formulas with numbers, its uncertainty."""
