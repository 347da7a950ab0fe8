"""Code that travels inside the FMUs, around kernel and model.

The Python slave, and the C shim of the native forms.
"""
