"""labsid: the reference functions of the system-identification lab, in the order in which they are taught."""

__version__ = "0.1.0"
