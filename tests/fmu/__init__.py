"""The exported FMU as its users meet it: in a fresh process, through an importer, without the
project.
"""
