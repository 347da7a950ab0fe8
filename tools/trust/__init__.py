"""The ledger of trust: campaigns against the project's own promises, and the records of them."""
