"""Records: files in every layout the lab meets, read into one `Record`, and what can be said of its signals."""
