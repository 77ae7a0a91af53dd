"""A simulation of several joints: effects are searched at one joint after the other, with all outputs scored."""
