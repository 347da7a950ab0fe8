"""Translate a function of the kernel to C: its statements, and where its variables are declared.

A body is read until the types of its variables no longer change, and then once more for its text.
"""

from __future__ import annotations

import ast
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from . import subset
from .expressions import OPERATORS, Expressions, Kernel, in_c, is_simple
from .values import MEMORY, NOTHING, REAL, WHOLE, Type, Unit, Value, common_type

WIDTH = 100
STORAGE = "static INLINE"  # of every function, until it is known how often it is called
INDENT = "    "
# comments on an if that say which way it usually goes, and what they are in C
HINTS = {"rarely": "RARELY", "usually": "USUALLY"}
INLINE = "inline"  # the comment on a def: it is to be inlined


class Body(Expressions):
    """Translator of one function: gives its unit a result and a text."""

    def __init__(self, kernel: Kernel, unit: Unit) -> None:
        self.kernel, self.unit = kernel, unit
        self.module = sys.modules[unit.function.__module__]
        self.tree, self.first, source = subset.parse_function(unit.function)
        self.comments = subset.comments_of(source)
        self.parameters = [argument.arg for argument in self.tree.args.args]
        if len(self.parameters) != len(unit.kinds):
            raise self.refuse(self.tree, "a call with other arguments", "all of them")
        self.types = dict(zip(self.parameters, unit.kinds, strict=True))
        self.results: list[Type] = []
        self.may_keep, self.is_final, self.is_rare = True, False, False
        known = (*HINTS, INLINE)
        self.hints = {line: text for line, text in self.comments.items() if text in known}
        for line in self.hints:
            del self.comments[line]
        self.reset()

    def reset(self) -> None:
        self.lines: list[str] = []
        self.declared, self.count_of_kept, self.depth = set(self.parameters), 0, 1

    def translate(self) -> None:
        body = self.tree.body[1:] if ast.get_docstring(self.tree) else self.tree.body
        known: dict[str, Type] = {}
        while known != self.types:  # a variable may turn out to be real after its first use
            known, self.results = dict(self.types), []
            self.reset()
            self.block(body)
        self.unit.result = common_type(self.results) if self.results else NOTHING
        self.is_final = True
        self.reset()
        self.declare_first(body)
        self.block(body)
        self.unit.text = "\n".join([*self.definition_head(), "{", *self.lines, "}"])

    def definition_head(self) -> list[str]:
        """Return the docstring's summary as a comment, and the function's declaration."""
        summary = " ".join((ast.get_docstring(self.tree) or "").partition("\n\n")[0].split())
        plain = summary.replace("``", "").replace(":func:", "").replace("`", "")
        comment = wrapped(f"/* {plain} */", "", "   ") if plain else []
        c_type = self.kernel.c_type
        parameters = [f"{c_type(self.types[name])} {in_c(name)}" for name in self.parameters]
        self.unit.is_inline = self.hints.get(self.tree.lineno) == INLINE
        line = f"{STORAGE} {c_type(self.unit.result)} {self.unit.name}({', '.join(parameters)})"
        return [*comment, *wrapped(line, "", INDENT)]

    # -- lines --

    def line(self, text: str) -> None:
        indent = INDENT * self.depth
        self.lines += wrapped(text, indent, indent + INDENT)

    def block(self, statements: subset.Block) -> None:
        for statement in statements:
            if self.is_final:
                for line in [line for line in sorted(self.comments) if line <= statement.lineno]:
                    self.line(f"/* {self.comments.pop(line)} */")
            self.statement(statement)

    def inner_block(self, statements: subset.Block) -> None:
        self.depth += 1
        self.block(statements)
        self.depth -= 1

    def declare_first(self, body: subset.Block) -> None:
        """Declare the variables that no assignment can declare, and name unused arguments."""
        used = set().union(*map(subset.names_in, body))
        for name in [name for name in self.parameters if name not in used]:
            self.line(f"(void){in_c(name)};")
        several: dict[Type, list[str]] = {}
        for name, owner in subset.owner_blocks(body).items():
            first = next(statement for statement in owner if name in subset.names_in(statement))
            if name not in self.declared and not subset.may_declare(first, name):
                self.declared.add(name)
                several.setdefault(self.types[name], []).append(name)
        for kind, names in several.items():
            zero = "{0}" if isinstance(kind, tuple) else "0.0" if kind == REAL else "0"
            self.line(
                f"{self.kernel.c_type(kind)} {', '.join(f'{in_c(n)} = {zero}' for n in names)};"
            )

    # -- statements --

    def statement(self, node: ast.stmt) -> None:
        known: Mapping[type, Callable[[Any], None]] = {
            ast.Assign: self.assign,
            ast.AugAssign: self.augmented_assignment,
            ast.Expr: self.call_alone,
            ast.Return: self.return_statement,
            ast.If: self.if_statement,
            ast.For: self.for_loop,
            ast.While: self.while_loop,
            ast.Break: lambda node: self.line("break;"),
        }
        if type(node) not in known:
            line = ast.unparse(node).splitlines()[0]
            raise self.refuse(node, line, "=, if, for, while, break, return or a call")
        known[type(node)](node)

    def assign(self, node: ast.Assign) -> None:
        target = node.targets[0]
        if isinstance(target, ast.Tuple) and len(node.targets) == 1:
            self.assign_parts(target.elts, node.value)
            return
        value = self.expression(node.value)
        if len(node.targets) > 1 and not is_simple(value):
            value = self.keep(value)
        for one in node.targets:
            if isinstance(one, ast.Subscript) and self.may_read(one.slice):
                value = self.keep(value)  # Python asks for the slot after it
            self.set(one, value)

    def assign_parts(self, targets: Sequence[ast.expr], source: ast.expr) -> None:
        if isinstance(source, ast.Tuple):
            parts = self.operands(source.elts)
            if subset.needs_temporaries(targets, source.elts):
                parts = [self.keep(part) for part in parts]
        else:
            whole = self.expression(source)
            if not isinstance(whole.type, tuple):
                raise self.refuse(source, ast.unparse(source), f"a tuple of {len(targets)}")
            parts = (whole if is_simple(whole) else self.keep(whole)).items()
        if len(parts) != len(targets):
            raise self.refuse(source, f"{len(parts)} values", f"{len(targets)} of them")
        for target, part in zip(targets, parts, strict=True):
            if not (isinstance(target, ast.Name) and target.id == "_"):
                self.set(target, part)

    def set(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Subscript):
            self.line(f"{self.subscript(target).text} = {value.converted(REAL).text};")
            return
        if not isinstance(target, ast.Name):
            raise self.refuse(target, ast.unparse(target), "a name or a slot of the memory")
        name, before = target.id, self.types.get(target.id, value.type)
        if before == MEMORY or isinstance(before, tuple) != isinstance(value.type, tuple):
            raise self.refuse(target, f"{name} with another type", "a name of its own")
        kind = self.types[name] = common_type([before, value.type])
        declaration = "" if name in self.declared else f"{self.kernel.c_type(kind)} "
        self.declared.add(name)
        self.line(f"{declaration}{in_c(name)} = {value.converted(kind).text};")

    def augmented_assignment(self, node: ast.AugAssign) -> None:
        if type(node.op) not in OPERATORS:
            raise self.refuse(node, ast.unparse(node), "+=, -=, *= or /=")
        sign = OPERATORS[type(node.op)][0]
        value = self.expression(node.value)
        if isinstance(node.target, ast.Name):
            name = node.target.id
            kind = self.types[name] = common_type([self.types[name], value.type])
            self.line(f"{in_c(name)} {sign}= {value.converted(kind).text};")
            return
        if self.may_write(node.value):  # Python reads the slot first
            raise self.refuse(node, ast.unparse(node), "the call in a statement of its own before")
        self.line(f"{self.expression(node.target).text} {sign}= {value.converted(REAL).text};")

    def call_alone(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Call):
            raise self.refuse(node, ast.unparse(node), "a call")
        self.line(f"{self.expression(node.value).text};")

    def return_statement(self, node: ast.Return) -> None:
        if node.value is None:
            self.results.append(NOTHING)
            self.line("return;")
            return
        value = self.expression(node.value)
        self.results.append(value.type)
        kind = self.unit.result if self.is_final else value.type
        self.line(f"return {value.converted(kind).text};")

    def if_statement(self, node: ast.If) -> None:
        hint, test, before = (
            self.hints.get(node.lineno, ""),
            self.truth(node.test).text,
            self.is_rare,
        )
        self.line(f"if ({HINTS[hint]}({test})) {{" if hint else f"if ({test}) {{")
        self.is_rare = before or hint == "rarely"
        self.inner_block(node.body)
        self.is_rare = before or hint == "usually"
        if node.orelse:
            self.line("} else {")
            self.inner_block(node.orelse)
        self.line("}")
        self.is_rare = before

    def for_loop(self, node: ast.For) -> None:
        loop, target = node.iter, node.target
        is_range = isinstance(loop, ast.Call) and ast.unparse(loop.func) == "range"
        ends = loop.args if is_range and isinstance(loop, ast.Call) else []
        if not ends or not isinstance(target, ast.Name) or node.orelse:
            raise self.refuse(node, "this loop", "for NAME in range(...)")
        values = [self.expression(end) for end in ends]
        first, last = (Value("0", WHOLE), *values) if len(values) == 1 else values[:2]
        step = ast.literal_eval(ends[2]) if len(values) == 3 else 1
        changed = {one.id for one in subset.assigned_in(node.body) if isinstance(one, ast.Name)}
        if last.text in changed or not (is_simple(last) or last.text.isdigit()):
            last = self.keep(last)  # Python asks for it once
        name = "round" if target.id == "_" else in_c(target.id)
        self.types[target.id] = WHOLE
        declaration = "" if target.id in self.declared else "int "
        while_in = f"{name} {'<' if step > 0 else '>'} {last.text}"
        further = {1: f"{name}++", -1: f"{name}--"}.get(step, f"{name} += {step}")
        before = set(self.declared)
        self.declared.add(target.id)
        self.line(f"for ({declaration}{name} = {first.text}; {while_in}; {further}) {{")
        self.inner_block(node.body)
        self.line("}")
        self.declared = before

    def while_loop(self, node: ast.While) -> None:
        (test,) = self.conditional([node.test], self.truth)
        self.line(f"while ({test.text}) {{")
        self.inner_block(node.body)
        self.line("}")


def wrapped(text: str, first: str, later: str) -> list[str]:
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
