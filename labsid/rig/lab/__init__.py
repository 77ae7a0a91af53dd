"""The coupled tanks of the lab and their records.

`integration` simulates a rig: a state derivative with a chain of actuator blocks and a chain of sensor blocks.
`tanks` holds the physics, `instruments` the sensor blocks, `plan` the parameters and input levels (shared or
individual), `lab_record` makes the records, and `log` writes them in the lab's file layout.
"""
