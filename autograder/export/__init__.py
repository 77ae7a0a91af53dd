"""Grades in the form that other systems take."""
