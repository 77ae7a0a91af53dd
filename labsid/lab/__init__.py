"""The UNSW lab in its order: offsets, Phi, theta, transfer function and state space, simulation, verification."""
