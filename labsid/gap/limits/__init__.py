"""What a record could have shown: the smallest size at which each effect is visible and named."""
