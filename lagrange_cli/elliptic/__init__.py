"""Elliptic integrals, Jacobi's functions, theta functions and nomes of both sources, in balls."""
