"""Keys and columns whose values are known as fractions."""
