"""Judging of one submission: run its cells, and compare its values with the reference."""
