"""What travels inside the FMUs around kernel and model: the Python slave, and the C shim of the
native forms.
"""
