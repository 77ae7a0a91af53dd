"""Rigs of several inputs and outputs whose effects can be switched on at one signal each.

`setup` describes a rig: linear dynamics, which effects extend, with an actuator for each input and a sensor for each
output. `plants` draws two pairs of tanks, two heaters, two joints, and a valve with a supply pressure. `inputs` draws
input signals that move independently. `effects` adds one of the effects that the diagnosis names, at one signal
or in the dynamics. `simulation` runs a rig, and `units` converts its signals to those of a record.

`loop_rigs` draws a pendulum, which may stand upright, and an axis, with the controller that holds them, and
`loop_simulation` runs them. The same effects can be added.
"""
