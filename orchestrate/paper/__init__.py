"""The paper's results as jobs, and the table of its claims: numbers only, no pictures and no command line."""
