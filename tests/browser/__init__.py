"""A browser on the pages that students, instructors and engineers see."""
