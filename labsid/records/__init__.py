"""Records: reading `.mat` and text files into a `Record`, and tests of the quality of its signals."""
