"""The `labsid` command: parse, call, print."""
