"""Pictures inside the FMUs and their documentation."""
