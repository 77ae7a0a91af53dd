"""The steps of the UNSW lab: offsets, Phi, theta, transfer function and state space, simulation, verification."""
