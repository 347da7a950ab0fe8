"""The exported FMU as its users meet it, in a process without the project where that matters."""
