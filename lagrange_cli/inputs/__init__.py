"""What is given: tops, scene files, ranges and files of tops."""
