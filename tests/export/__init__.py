"""The exporters: which sources an FMU is made of, and what they need to be asked."""
