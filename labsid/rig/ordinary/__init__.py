"""Ordinary records, as people bring them: most have no gap, the others one that is easy to see.

`kinds.KINDS` has a draw for each kind, which takes a random generator and returns an `OrdinaryRecord`: the files, the
words of the command line, and the answers that are right. An effect that a record does not exercise is no effect of it.

- `measured`: systems with a direct term, plain and integrating ones, slow noise; sensors that clip.
- `exact`: records without noise, printed with 17, 6 or 4 digits or in single precision.
- `simulations`: a simulation beside its own output, and simulated output as a file.
- `commands`: commands that are logged otherwise than they act.
- `free_numbers`: simulations with free numbers that are far off, or that the record does not determine.

`signals`, `systems`, `functions` and `record_files` are what these share. Nothing is shared with
`labsid.rig.switchable`.
"""
