"""Derivatives of the numbers and angles by the inputs, and uncertainties."""
