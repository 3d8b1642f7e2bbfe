"""The functions of both sources: elliptic integrals, Jacobi's functions, theta functions and nomes.

Every function takes the arithmetic as its first argument: `arithmetic.arrays.ARRAYS` for NumPy
arrays, or `elliptic.many_digits.ManyDigits(n)`, an mpmath context (any number of digits; complex
arguments); those of `complete` and R_F also `arithmetic.decimals` and `arithmetic.numbers.DOUBLES`.
Conventions: modulus k, complement k', parameter m = k^2, nome q = exp(-pi K'/K), always named in
the call (`modulus(ARRAYS, k_prime=1e-9)`), so that they cannot be confused.  The complement is
passed in beside the modulus; 1 - k^2 is never formed, so nothing is lost as k -> 1.

The modules are `complete` (K, E, the nome, the agm), `carlson` (R_F and others), `modulus`,
`jacobi` (am, sn, cn, dn), `theta` (theta and Zeta functions), `third_kind` (Omega and Pi),
`incomplete` (F and E of an amplitude), `nome_series`, `eta`, and the tables of the commands:
`tables` is their engine, `function_table` (with `known_values`), `complex_table`,
`amplitude_table`, `series_table` and `eta_table` declare the columns. No command
calls these; they are for the library alone: `carlson_rj`, `carlson_rc` of `carlson`, and the
functions of `theta` and `third_kind` over arrays of moduli or of complex arguments. Domains, units
and errors of all of them: README.md in this folder.
"""
