"""The record of a diagnosis: its sampling time, faulty samples, scale and held-out blocks."""
