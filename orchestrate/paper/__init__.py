"""The paper: a client of the public questions, its pictures, and a table of its claims."""
