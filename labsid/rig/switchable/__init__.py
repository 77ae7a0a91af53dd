"""Rigs whose unmodelled effects can be switched on one by one, at any strength.

`setup` describes a rig. `plants` draws rigs and `inputs` draws input signals. `effects`, `variants` and `unlisted` add
an unmodelled effect: one that the diagnosis names (`labsid gap effects`), another form of one, or another effect.
`simulation` runs a rig and `truth` states its true parameters. `joints` has the joints of robots, with an integration
of their own, and `coupled` the rigs of several signals and those in a closed loop. `withheld` makes the individual rigs
of ``sim-to-real-gap``, each with one of the `withheld_effects`.
"""
