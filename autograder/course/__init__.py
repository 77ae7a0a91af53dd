"""The course: its files, the build of source and release notebooks, and the student release."""
