"""Held-out errors, probabilities, and the verdict."""
