"""Case files: each table is a form, a dataclass whose fields say what its keys accept."""
