"""Elements and texts of an HTML page; whatever is opened is closed."""

from html.parser import HTMLParser

VOID = ("meta", "img", "input", "link")  # elements that end by themselves


class Elements(HTMLParser):
    """The elements of a page with their attributes, and its texts."""

    def __init__(self, html):
        super().__init__()
        self.all, self.open, self.texts = [], [], []
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.all.append((tag, dict(attrs)))
        self.open += [tag] if tag not in VOID else []

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)

    @property
    def tags(self):
        return [tag for tag, _ in self.all]

    @property
    def attributes(self):
        return {name for _, attributes in self.all for name in attributes}
