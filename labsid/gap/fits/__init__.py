"""A hypothesis fitted to a record, and what is left of the record then."""
