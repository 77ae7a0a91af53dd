"""Records: reading logs of any usual format into a `Record`, and tests of the quality of its signals."""
