"""Diagnosis of every record of a folder."""
