"""Reading of submissions: Moodle's zip file and worksheet, and notebooks of any quality."""
