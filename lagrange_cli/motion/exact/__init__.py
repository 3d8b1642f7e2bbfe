"""Keys and columns that are known as fractions."""
