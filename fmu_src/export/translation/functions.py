"""Translate a function of the kernel to C: its statements, and where its variables are declared.

A body is read until the types of its variables no longer change, and then once more for its text.
"""

from __future__ import annotations

import ast
import sys
import textwrap
from collections.abc import Sequence

from . import subset
from .expressions import OPERATORS, Expressions, Kernel, c_name, is_simple_name
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
            raise self.refusal(self.tree, "a call with other arguments", "all of them")
        self.types = dict(zip(self.parameters, unit.kinds, strict=True))
        self.results: list[Type] = []
        self.may_keep, self.is_final, self.is_rare = True, False, False
        known = (*HINTS, INLINE)
        self.hints = {line: text for line, text in self.comments.items() if text in known}
        for line in self.hints:
            del self.comments[line]
        self.clear_text()

    def clear_text(self) -> None:
        self.lines: list[str] = []
        self.declared, self.count_of_kept, self.depth = set(self.parameters), 0, 1

    def translate(self) -> None:
        body = self.tree.body[1:] if ast.get_docstring(self.tree) else self.tree.body
        known: dict[str, Type] = {}
        while known != self.types:  # a variable may turn out to be real after its first use
            known, self.results = dict(self.types), []
            self.clear_text()
            self.translate_block(body)
        self.unit.result = common_type(self.results) if self.results else NOTHING
        self.is_final = True
        self.clear_text()
        self.declare_ahead(body)
        self.translate_block(body)
        self.unit.text = "\n".join([*self.comment_and_declaration(), "{", *self.lines, "}"])

    def comment_and_declaration(self) -> list[str]:
        """Return the docstring's summary as a comment, and the function's declaration."""
        summary = " ".join((ast.get_docstring(self.tree) or "").partition("\n\n")[0].split())
        plain = summary.replace("``", "").replace(":func:", "").replace("`", "")
        comment = wrap_lines(f"/* {plain} */", "", "   ") if plain else []
        c_type = self.kernel.c_type_name
        parameters = [f"{c_type(self.types[name])} {c_name(name)}" for name in self.parameters]
        self.unit.is_inline = self.hints.get(self.tree.lineno) == INLINE
        line = f"{STORAGE} {c_type(self.unit.result)} {self.unit.name}({', '.join(parameters)})"
        return [*comment, *wrap_lines(line, "", INDENT)]

    # -- lines --

    def write_line(self, text: str) -> None:
        indent = INDENT * self.depth
        self.lines += wrap_lines(text, indent, indent + INDENT)

    def translate_block(self, statements: subset.Block) -> None:
        for statement in statements:
            if self.is_final:
                for line in [line for line in sorted(self.comments) if line <= statement.lineno]:
                    self.write_line(f"/* {self.comments.pop(line)} */")
            self.visit(statement)

    def translate_inner_block(self, statements: subset.Block) -> None:
        self.depth += 1
        self.translate_block(statements)
        self.depth -= 1

    def declare_ahead(self, body: subset.Block) -> None:
        """Declare the variables that no assignment can declare, and name unused arguments."""
        used = set().union(*map(subset.names_in, body))
        for name in [name for name in self.parameters if name not in used]:
            self.write_line(f"(void){c_name(name)};")
        several: dict[Type, list[str]] = {}
        for name, owner in subset.owner_blocks(body).items():
            first = next(statement for statement in owner if name in subset.names_in(statement))
            if name not in self.declared and not subset.can_declare(first, name):
                self.declared.add(name)
                several.setdefault(self.types[name], []).append(name)
        for kind, names in several.items():
            zero = "{0}" if isinstance(kind, tuple) else "0.0" if kind == REAL else "0"
            variables = ", ".join(f"{c_name(name)} = {zero}" for name in names)
            self.write_line(f"{self.kernel.c_type_name(kind)} {variables};")

    # -- statements --

    def generic_visit(self, node: ast.AST) -> None:
        if isinstance(node, ast.stmt):
            expected = "=, if, for, while, break, return or a call"
            raise self.refusal(node, ast.unparse(node).splitlines()[0], expected)
        super().generic_visit(node)

    def visit_Break(self, node: ast.Break) -> None:
        self.write_line("break;")

    def visit_Assign(self, node: ast.Assign) -> None:
        target = node.targets[0]
        if isinstance(target, ast.Tuple) and len(node.targets) == 1:
            self.translate_tuple_assignment(target.elts, node.value)
            return
        value = self.translate_expression(node.value)
        if len(node.targets) > 1 and not is_simple_name(value):
            value = self.keep_in_variable(value)
        for one in node.targets:
            if isinstance(one, ast.Subscript) and self.may_read_memory(one.slice):
                value = self.keep_in_variable(value)  # Python asks for the slot after it
            self.write_assignment(one, value)

    def translate_tuple_assignment(self, targets: Sequence[ast.expr], source: ast.expr) -> None:
        if isinstance(source, ast.Tuple):
            parts = self.translate_in_order(source.elts)
            if subset.needs_temporaries(targets, source.elts):
                parts = [self.keep_in_variable(part) for part in parts]
        else:
            whole = self.translate_expression(source)
            if not isinstance(whole.type, tuple):
                raise self.refusal(source, ast.unparse(source), f"a tuple of {len(targets)}")
            parts = (whole if is_simple_name(whole) else self.keep_in_variable(whole)).items()
        if len(parts) != len(targets):
            raise self.refusal(source, f"{len(parts)} values", f"{len(targets)} of them")
        for target, part in zip(targets, parts, strict=True):
            if not (isinstance(target, ast.Name) and target.id == "_"):
                self.write_assignment(target, part)

    def write_assignment(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Subscript):
            slot = self.translate_expression(target).text
            self.write_line(f"{slot} = {value.converted_to(REAL).text};")
            return
        if not isinstance(target, ast.Name):
            raise self.refusal(target, ast.unparse(target), "a name or a slot of the memory")
        name, before = target.id, self.types.get(target.id, value.type)
        if before == MEMORY or isinstance(before, tuple) != isinstance(value.type, tuple):
            raise self.refusal(target, f"{name} with another type", "a name of its own")
        kind = self.types[name] = common_type([before, value.type])
        declaration = "" if name in self.declared else f"{self.kernel.c_type_name(kind)} "
        self.declared.add(name)
        self.write_line(f"{declaration}{c_name(name)} = {value.converted_to(kind).text};")

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        if type(node.op) not in OPERATORS:
            raise self.refusal(node, ast.unparse(node), "+=, -=, *= or /=")
        sign = OPERATORS[type(node.op)][0]
        value = self.translate_expression(node.value)
        if isinstance(node.target, ast.Name):
            name = node.target.id
            kind = self.types[name] = common_type([self.types[name], value.type])
            self.write_line(f"{c_name(name)} {sign}= {value.converted_to(kind).text};")
            return
        if self.may_write_memory(node.value):  # Python reads the slot first
            raise self.refusal(node, ast.unparse(node), "the call in a statement of its own before")
        slot = self.translate_expression(node.target).text
        self.write_line(f"{slot} {sign}= {value.converted_to(REAL).text};")

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Call):
            raise self.refusal(node, ast.unparse(node), "a call")
        self.write_line(f"{self.translate_expression(node.value).text};")

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is None:
            self.results.append(NOTHING)
            self.write_line("return;")
            return
        value = self.translate_expression(node.value)
        self.results.append(value.type)
        kind = self.unit.result if self.is_final else value.type
        self.write_line(f"return {value.converted_to(kind).text};")

    def visit_If(self, node: ast.If) -> None:
        hint, before = self.hints.get(node.lineno, ""), self.is_rare
        test = self.translate_test(node.test).text
        self.write_line(f"if ({HINTS[hint]}({test})) {{" if hint else f"if ({test}) {{")
        self.is_rare = before or hint == "rarely"
        self.translate_inner_block(node.body)
        self.is_rare = before or hint == "usually"
        if node.orelse:
            self.write_line("} else {")
            self.translate_inner_block(node.orelse)
        self.write_line("}")
        self.is_rare = before

    def visit_For(self, node: ast.For) -> None:
        loop, target = node.iter, node.target
        is_range = isinstance(loop, ast.Call) and ast.unparse(loop.func) == "range"
        ends = loop.args if is_range and isinstance(loop, ast.Call) else []
        if not ends or not isinstance(target, ast.Name) or node.orelse:
            raise self.refusal(node, "this loop", "for NAME in range(...)")
        values = [self.translate_expression(end) for end in ends]
        first, last = (Value("0", WHOLE), *values) if len(values) == 1 else values[:2]
        step = ast.literal_eval(ends[2]) if len(values) == 3 else 1
        changed = {ast.unparse(one) for one in subset.assigned_targets_in(node.body)}
        if last.text in changed or not (is_simple_name(last) or last.text.isdigit()):
            last = self.keep_in_variable(last)  # Python asks for it once
        name = "round" if target.id == "_" else c_name(target.id)
        self.types[target.id] = WHOLE
        declaration = "" if target.id in self.declared else "int "
        while_in = f"{name} {'<' if step > 0 else '>'} {last.text}"
        further = {1: f"{name}++", -1: f"{name}--"}.get(step, f"{name} += {step}")
        before = set(self.declared)
        self.declared.add(target.id)
        self.write_line(f"for ({declaration}{name} = {first.text}; {while_in}; {further}) {{")
        self.translate_inner_block(node.body)
        self.write_line("}")
        self.declared = before

    def visit_While(self, node: ast.While) -> None:
        (test,) = self.translate_without_variables([node.test], self.translate_test)
        self.write_line(f"while ({test.text}) {{")
        self.translate_inner_block(node.body)
        self.write_line("}")


def wrap_lines(text: str, first: str, later: str) -> list[str]:
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
