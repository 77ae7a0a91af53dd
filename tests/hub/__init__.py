"""JupyterHub with users of its own: a term on it, and what a student tries."""
