"""Derivatives of numbers and angles with respect to the inputs, and uncertainties."""
