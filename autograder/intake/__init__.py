"""Submissions as they arrive: archives, Moodle's worksheet, notebooks that are damaged."""
