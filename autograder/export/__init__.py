"""Export of grades and feedback to other systems."""
