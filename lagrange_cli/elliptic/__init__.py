"""The functions of both sources: elliptic integrals, Jacobi's functions, theta functions and nomes.

Every function takes the arithmetic as its first argument: `arithmetic.arrays.ARRAYS` for NumPy
arrays, or `many_digits.ManyDigits(n)`, an mpmath context (any number of digits; complex arguments).
Modulus k, complement k', parameter m = k^2 and nome q = exp(-pi K'/K) are always named in the call,
and 1 - k^2 is never formed, so nothing is lost as k -> 1.  Files, domains and errors: README.md.
"""
