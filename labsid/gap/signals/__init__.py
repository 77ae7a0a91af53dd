"""Records of several inputs and outputs."""
