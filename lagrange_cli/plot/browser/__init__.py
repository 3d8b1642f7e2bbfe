"""The page of a top for the browser: one file, with the closed form in it."""
