"""The command-line interface `labsid`."""
