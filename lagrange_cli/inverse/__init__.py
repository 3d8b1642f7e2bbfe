"""The inverse problem: the top behind a recording (`fit`)."""
