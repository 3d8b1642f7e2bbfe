"""What is written: formats, tables and files."""
