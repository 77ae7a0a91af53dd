"""Recursive estimation, ARMAX, instrumental variables, maximum likelihood, and Monte Carlo studies of them."""
