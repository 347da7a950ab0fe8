"""``simulate``: time histories."""


def add_parser(commands):
    pass
