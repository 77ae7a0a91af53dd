"""Where student code runs: a process for each submission, isolated from the judge."""
