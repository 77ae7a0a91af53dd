"""The course as files: text notebooks built into source and release, and what students receive."""
