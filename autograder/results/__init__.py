"""Stored results, the gradebook, feedback pages and the class report."""
