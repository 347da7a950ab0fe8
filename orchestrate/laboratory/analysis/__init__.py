"""What an analyser shows of a record, measured or simulated."""
