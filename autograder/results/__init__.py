"""Stored results, the gradebook, feedback pages and the instructor's report."""
