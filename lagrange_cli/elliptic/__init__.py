"""Elliptic integrals, Jacobi's functions, theta functions and nomes of both sources.

`functions` evaluates them as balls of Arb, and the tables round each number from its ball.
`complete` and `carlson` serve the solver and arrays; they take the arithmetic as first argument.

A modulus comes with its complement k'.  No function forms 1 - k^2, so no digits are lost as k -> 1.
"""
