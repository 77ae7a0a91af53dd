"""Simulations that users give, and files of corrected simulations."""
