"""Elliptic integrals, Jacobi's functions, theta functions and nomes of both sources.

`functions` and `legendre` evaluate them as balls of Arb; the tables round each number once.
"""
