"""The report as JSON, text, page and notebook output."""
