"""Elliptic integrals, Jacobi's functions, theta functions and nomes of both sources.

Every function takes the arithmetic as its first argument: `arithmetic.arrays.ARRAYS` for NumPy
arrays, or `many_digits.ManyDigits(n)`, an mpmath context (any number of digits; complex arguments).

Calls name the modulus k, the complement k', the parameter m = k^2 or the nome q = exp(-pi K'/K).
No function forms 1 - k^2, so no digits are lost as k -> 1.  See README.md for files, domains and
errors.
"""
