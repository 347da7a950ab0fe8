"""All ways in which a module is broken: one number, comparison or operator at a time."""

import ast
from typing import NamedTuple

NEGATED = {
    **{ast.Lt: ">=", ast.GtE: "<", ast.Gt: "<=", ast.LtE: ">", ast.Eq: "!=", ast.NotEq: "=="},
    **{ast.In: "not in", ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is"},
}
SWAPPED = {ast.Add: "-", ast.Sub: "+"}


class Breakage(NamedTuple):
    """A line, and what is made of it."""

    line: int
    text: str  # before
    broken: str
    source: str  # of the whole module
    threshold: bool  # a field's default of a class of settings


def breakages(source):
    return sorted(one for one in changes(source) if is_whole(one.source))


def changes(source):
    """Return all changes of a module, also those that leave no Python."""
    tree, lines = ast.parse(source), [line.encode() for line in source.splitlines(keepends=True)]
    indices = {id(part) for node in ast.walk(tree) for part in subscripts(node)}
    nodes = [node for node in ast.walk(tree) if id(node) not in indices]
    edits = sorted({edit for node in nodes for edit in edits_of(node, lines)})
    classes = (one for one in ast.walk(tree) if isinstance(one, ast.ClassDef))
    settings = (one for it in classes if it.name.endswith("Settings") for one in it.body)
    fields = {one.lineno for one in settings if isinstance(one, ast.AnnAssign) and one.value}
    found = (broken_by(edit, lines, edit[0] in fields) for edit in edits)
    return {(one.text, one.broken): one for one in found}.values()


def subscripts(node):
    """Slots of the kernels' memory are no numbers, nor are annotations; of 1.0 / 6.0 one counts."""
    hidden = [node.slice] if isinstance(node, ast.Subscript) else []
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        hidden += [node.left] if isinstance(node.left, ast.Constant) else []
    hidden += [getattr(node, name, None) for name in ("annotation", "returns")]
    return [part for one in hidden if one is not None for part in ast.walk(one)]


def edits_of(node, lines):
    """Yield first line, column, last line, column and new text of all edits of one node."""
    if isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value:
        written = lines[node.lineno - 1][node.col_offset : node.end_col_offset].decode()
        for text in numbers(node.value, written):
            yield *span(node), text
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield *between(node.left, node.comparators[0]), f" {NEGATED[type(node.ops[0])]} "
    elif isinstance(node, ast.BinOp) and type(node.op) in SWAPPED and not is_text(node):
        yield *between(node.left, node.right), f" {SWAPPED[type(node.op)]} "
    elif isinstance(node, ast.BoolOp):
        for left, right in zip(node.values, node.values[1:], strict=False):
            yield *between(left, right), f" {'or' if isinstance(node.op, ast.And) else 'and'} "
    elif isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("min", "max"):
        yield *span(node.func), "max" if node.func.id == "min" else "min"


def numbers(value, text):
    if isinstance(value, int):
        return str(max(value + 1, int(1.5 * value))), str(min(value - 1, int(value / 1.5)))
    return f"({text} * 1.5)", f"({text} / 1.5)"


def is_text(node):
    kinds = (ast.JoinedStr, ast.List, ast.Tuple)
    texts = (isinstance(getattr(one, "value", None), str) for one in (node.left, node.right))
    return any(texts) or isinstance(node.left, kinds) or isinstance(node.right, kinds)


def is_whole(source):
    """Whether a source is Python at all: a comment between two operands is not taken apart."""
    try:
        compile(source, "broken", "exec")
    except SyntaxError:
        return False
    return True


def span(node):
    return node.lineno, node.col_offset, node.end_lineno, node.end_col_offset


def between(left, right):
    return left.end_lineno, left.end_col_offset, right.lineno, right.col_offset


def broken_by(edit, lines, threshold):
    """Return the breakage by one edit; brackets between the operands stay."""
    first, column, last, end, text = edit
    begin, stop = (sum(map(len, lines[: n - 1])) + at for n, at in ((first, column), (last, end)))
    whole = b"".join(lines)
    gap = whole[begin:stop].decode()
    if text.startswith(" "):  # an operator
        closing = gap[: len(gap) - len(gap.lstrip(" )\n"))]
        opening = gap[len(gap.rstrip(" (\n")) :]
        text = closing.rstrip(" ") + text + opening.lstrip(" ")
    broken = (whole[:begin] + text.encode() + whole[stop:]).decode()
    made = broken.splitlines()
    before, changed = lines[first - 1].decode().strip(), made[first - 1].strip()
    if changed == before:  # an operator that begins the next line
        before, changed = lines[first].decode().strip(), made[first].strip()
    return Breakage(first, before, changed, broken, threshold)
