"""The inverse problem: inputs for target results, and the top behind a recording."""
