"""The exported FMU as its users meet it: by FMI calls, in a fresh process without the project where
that matters.
"""
