"""Simulations that users bring along: Python functions, systems of python-control, and co-simulation FMUs."""
