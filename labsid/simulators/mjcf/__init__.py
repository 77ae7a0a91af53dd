"""Models of MuJoCo (MJCF, or URDF that MuJoCo reads) as simulations of a rig, with effects inside a joint."""
