"""Draw the pictures of README, manual and the FMUs' documentation."""
