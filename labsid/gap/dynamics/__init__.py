"""Simulation of the dynamics between actuator and sensor."""
