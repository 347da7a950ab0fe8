"""Translate an expression of the kernel to C.

Operations keep their order. Where C leaves the order of evaluation open, and one part may change
the memory that another one reads, the parts are kept in variables before.
"""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from types import FunctionType, ModuleType
from typing import Protocol

from ..errors import CannotExport
from .subset import original_definition, resolve_name, writes_memory
from .values import (
    AND,
    ATOM,
    BITS,
    CHOICE,
    EQUALITY,
    LONG,
    MEMORY,
    OR,
    PRODUCT,
    REAL,
    RELATION,
    SUM,
    TRUTH,
    UNARY,
    WHOLE,
    Type,
    Unit,
    Value,
    common_type,
)

OPERATORS: Mapping[type, tuple[str, int]] = {
    ast.Add: ("+", SUM),
    ast.Sub: ("-", SUM),
    ast.Mult: ("*", PRODUCT),
    ast.Div: ("/", PRODUCT),
    ast.Mod: ("%", PRODUCT),
    ast.BitAnd: ("&", BITS),
}
COMPARISONS: Mapping[type, tuple[str, int]] = {
    ast.Eq: ("==", EQUALITY),
    ast.NotEq: ("!=", EQUALITY),
    ast.Lt: ("<", RELATION),
    ast.LtE: ("<=", RELATION),
    ast.Gt: (">", RELATION),
    ast.GtE: (">=", RELATION),
}
BUILT_IN = {  # of <math.h>, or a helper of the C file
    "abs": "fabs",
    "math.sqrt": "sqrt",
    "math.floor": "floored",
    "max": "larger",
    "min": "smaller",
    "int": "(int)",
}
# C's own words, what <math.h> may declare, and the helpers
WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while finite isinf isnan signbit larger smaller floored
"""
TAKEN = frozenset(WORDS.split())


class Kernel(Protocol):
    """What the translation of a function asks the translation of the kernel for."""

    begun: set[FunctionType]

    def constant_name(self, module: ModuleType, name: str) -> str:
        """Return the name in C of a module's number."""

    def c_type_name(self, kind: Type) -> str:
        """Return the name in C of a type."""

    def translated_unit(self, function: FunctionType, kinds: tuple[Type, ...]) -> Unit:
        """Return another function, translated."""


class Expressions(ast.NodeVisitor, ABC):
    """Translator of the expressions in a function: a visit of one returns its value."""

    kernel: Kernel
    unit: Unit
    module: ModuleType
    tree: ast.FunctionDef
    first: int  # line of the function in its file
    types: dict[str, Type]  # of the variables known so far
    # whether values can be kept in variables before the present statement: not where C evaluates an
    # expression only if another one is true, or again
    may_keep: bool
    is_rare: bool
    count_of_kept: int

    @abstractmethod
    def write_line(self, text: str) -> None:
        """Write one line of C before the present statement."""

    def refusal(self, node: ast.AST, found: str, expected: str) -> CannotExport:
        line = self.first + getattr(node, "lineno", 1) - 1
        return CannotExport(f"{self.module.__file__}, line {line}: {found}; expected {expected}")

    def keep_in_variable(self, value: Value) -> Value:
        if not self.may_keep:
            instead = "it in a statement of its own before"
            raise self.refusal(self.tree, f"{value.text} would be evaluated too early", instead)
        self.count_of_kept += 1
        name = f"part_{self.count_of_kept}"
        self.write_line(f"{self.kernel.c_type_name(value.type)} {name} = {value.text};")
        return Value(name, value.type)

    def translated_function(
        self, node: ast.AST, function: FunctionType, kinds: tuple[Type, ...]
    ) -> tuple[str, Type]:
        if function in self.kernel.begun:  # nobody could say how much stack it takes
            raise self.refusal(node, f"{function.__name__} calls itself", "a loop, no recursion")
        unit = self.kernel.translated_unit(function, kinds)
        if not self.is_rare:
            self.unit.often.add(unit.name)
        return unit.name, unit.result

    def translate_expression(self, node: ast.expr) -> Value:
        value = self.visit(node)
        assert isinstance(value, Value)
        return value

    def generic_visit(self, node: ast.AST) -> None:
        raise self.refusal(node, ast.unparse(node), "numbers, slots, + - * / and calls")

    def visit_Tuple(self, node: ast.Tuple) -> Value:
        return self.make_tuple(self.translate_in_order(node.elts))

    # -- what is read --

    def visit_Constant(self, node: ast.Constant) -> Value:
        if isinstance(node.value, bool):
            return Value(str(int(node.value)), TRUTH)
        if isinstance(node.value, (int, float)):
            return Value(repr(node.value), WHOLE if isinstance(node.value, int) else REAL)
        raise self.refusal(node, repr(node.value), "a number")

    def visit_Name(self, node: ast.Name | ast.Attribute) -> Value:
        if isinstance(node, ast.Name) and node.id in self.types:
            return Value(c_name(node.id), self.types[node.id])
        thing, module, name = self.resolve(node)
        if isinstance(thing, bool) or not isinstance(thing, (int, float)):
            raise self.refusal(node, ast.unparse(node), "a number")
        kind = WHOLE if isinstance(thing, int) else REAL
        return Value(self.kernel.constant_name(module, name), kind)

    visit_Attribute = visit_Name

    def resolve(self, node: ast.expr) -> tuple[object, ModuleType, str]:
        name = ast.unparse(node)
        thing = resolve_name(self.module, name)
        if thing is None:
            raise self.refusal(node, f"{name} is not known here", "a variable or a constant")
        if isinstance(node, ast.Attribute):
            module = resolve_name(self.module, ast.unparse(node.value))
            assert isinstance(module, ModuleType)
            return thing, *original_definition(module, node.attr)
        return thing, *original_definition(self.module, name)

    def visit_Subscript(self, node: ast.Subscript) -> Value:
        if self.is_constant_table(node.value):
            numbers, module, name = self.resolve(node.value)
            assert isinstance(numbers, tuple)
            place = self.translate_expression(node.slice)
            if place.type != WHOLE:
                raise self.refusal(node, ast.unparse(node), "a whole number as the index")
            kind = WHOLE if all(isinstance(n, int) for n in numbers) else REAL
            return Value(f"{self.kernel.constant_name(module, name)}[{place.text}]", kind)
        whole = self.translate_expression(node.value)
        if whole.type == MEMORY:
            place = self.translate_expression(node.slice)
            if place.type != WHOLE:
                raise self.refusal(node, ast.unparse(node), "a whole number as the slot")
            return Value(f"{whole.text}[{place.text}]", REAL)
        if not isinstance(whole.type, tuple):
            raise self.refusal(node, ast.unparse(node), "a slot or a part of a tuple")
        if isinstance(node.slice, ast.Slice):
            simple = whole if is_simple_name(whole) else self.keep_in_variable(whole)
            ends = [getattr(node.slice, end) for end in ("lower", "upper", "step")]
            wanted = slice(*(end and ast.literal_eval(end) for end in ends))
            return self.make_tuple(simple.items()[wanted])
        index = node.slice.value if isinstance(node.slice, ast.Constant) else None
        if not isinstance(index, int):
            raise self.refusal(node, ast.unparse(node), "a constant index of a tuple")
        return whole.item(index)

    def is_constant_table(self, node: ast.expr) -> bool:
        if not isinstance(node, (ast.Name, ast.Attribute)) or ast.unparse(node) in self.types:
            return False
        thing = resolve_name(self.module, ast.unparse(node))
        return isinstance(thing, tuple) and all(isinstance(n, (int, float)) for n in thing)

    # -- what is computed --

    def visit_BinOp(self, node: ast.BinOp) -> Value:
        if type(node.op) not in OPERATORS:
            raise self.refusal(node, ast.unparse(node), "one of + - * / % &")
        sign, rank = OPERATORS[type(node.op)]
        one, other = self.translate_in_order([node.left, node.right])
        kind = common_type([one.type, other.type, WHOLE])
        if sign in "%&" and kind == REAL:
            raise self.refusal(node, ast.unparse(node), "whole numbers")
        if sign == "/" and kind != REAL:  # Python's division of whole numbers is a real number
            one, kind = Value(f"(double){one.text_within(UNARY)}", REAL, UNARY), REAL
        one, other = one.converted_to(kind), other.converted_to(kind)
        return Value(f"{one.text_within(rank)} {sign} {other.text_within(rank + 1)}", kind, rank)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Value:
        if isinstance(node.op, ast.Not):
            return Value(f"!{self.translate_test(node.operand).text_within(UNARY)}", TRUTH, UNARY)
        if not isinstance(node.op, ast.USub):
            raise self.refusal(node, ast.unparse(node), "- or not")
        value = self.translate_expression(node.operand)
        text = value.text_within(UNARY)
        return Value(f"-({text})" if text.startswith("-") else f"-{text}", value.type, UNARY)

    def translate_test(self, node: ast.expr) -> Value:
        value = self.translate_expression(node)
        if value.type != TRUTH:
            raise self.refusal(node, ast.unparse(node), "a comparison")
        return value

    def visit_BoolOp(self, node: ast.BoolOp) -> Value:
        sign, rank = ("&&", AND) if isinstance(node.op, ast.And) else ("||", OR)
        first, *others = node.values
        values = [self.translate_test(first)]
        values += self.translate_without_variables(others, self.translate_test)
        # C's compilers ask for parentheses around && within ||
        return Value(f" {sign} ".join(value.text_within(BITS) for value in values), TRUTH, rank)

    def visit_Compare(self, node: ast.Compare) -> Value:
        first, *others = self.translate_in_order([node.left, *node.comparators])
        middle = [
            v if is_simple_name(v) or "(" not in v.text else self.keep_in_variable(v)
            for v in others[:-1]
        ]
        values = [first, *middle, others[-1]]
        pairs = []
        for operator, one, other in zip(node.ops, values[:-1], values[1:], strict=True):
            sign, rank = COMPARISONS[type(operator)]
            kind = common_type([one.type, other.type])
            left, right = (value.converted_to(kind).text_within(rank + 1) for value in (one, other))
            pairs.append(Value(f"{left} {sign} {right}", TRUTH, rank))
        if len(pairs) == 1:
            return pairs[0]
        return Value(" && ".join(pair.text for pair in pairs), TRUTH, AND)

    def visit_IfExp(self, node: ast.IfExp) -> Value:
        test = self.translate_test(node.test)
        parts = [node.body, node.orelse]
        one, other = self.translate_without_variables(parts, self.translate_expression)
        kind = common_type([one.type, other.type])
        yes, no = one.converted_to(kind), other.converted_to(kind)
        text = f"{test.text_within(OR)} ? {yes.text_within(OR)} : {no.text_within(CHOICE)}"
        return Value(text, kind, CHOICE)

    def translate_without_variables(
        self, nodes: Sequence[ast.expr], read: Callable[[ast.expr], Value]
    ) -> list[Value]:
        """Translate what is evaluated only where a test says so: nothing may be kept before."""
        before, self.may_keep = self.may_keep, False
        values = [read(node) for node in nodes]
        self.may_keep = before
        return values

    def make_tuple(self, parts: Sequence[Value]) -> Value:
        kind = tuple(part.type for part in parts)
        texts = ", ".join(part.text for part in parts)
        return Value(f"({self.kernel.c_type_name(kind)}){{{texts}}}", kind)

    def visit_Call(self, node: ast.Call) -> Value:
        name = ast.unparse(node.func)
        if node.keywords:
            raise self.refusal(node, ast.unparse(node), "arguments without names")
        if name in BUILT_IN:
            return self.translate_built_in(node, name)
        thing, _, _ = self.resolve(node.func)
        if not isinstance(thing, FunctionType):
            raise self.refusal(node, name, f"a function of the kernel, or {', '.join(BUILT_IN)}")
        values = self.translate_in_order(node.args)
        known, result = self.translated_function(node, thing, tuple(value.type for value in values))
        return Value(f"{known}({', '.join(value.text for value in values)})", result)

    def translate_built_in(self, node: ast.Call, name: str) -> Value:
        """Translate a call of a function that every C has, or of a helper of the C file."""
        values = self.translate_in_order(node.args)
        kind = common_type([value.type for value in values])
        if name == "int":
            return Value(f"(int){values[0].text_within(UNARY)}", WHOLE, UNARY)
        if name in ("max", "min", "abs") and kind != REAL:
            raise self.refusal(node, ast.unparse(node), "real numbers")
        text = values[0].converted_to(REAL).text
        if name == "math.floor":
            whole = f"{BUILT_IN[name]}({text})"
            return Value(f"(long long){whole}", LONG, UNARY, real=whole)
        if name not in ("max", "min"):
            return Value(f"{BUILT_IN[name]}({text})", REAL)
        for other in values[1:]:
            text = f"{BUILT_IN[name]}({text}, {other.converted_to(REAL).text})"
        return Value(text, REAL)

    # -- the order of evaluation --

    def translate_in_order(self, nodes: Sequence[ast.expr]) -> list[Value]:
        """Translate expressions that Python evaluates in this order, and C in any."""
        readers = [self.may_read_memory(node) for node in nodes]
        if sum(readers) < 2 or not any(self.may_write_memory(node) for node in nodes):
            return [self.translate_expression(node) for node in nodes]
        values = []
        for node, reads in zip(nodes, readers, strict=True):
            value = self.translate_expression(node)
            values.append(self.keep_in_variable(value) if reads else value)
        return values

    def may_read_memory(self, node: ast.expr) -> bool:
        """Return whether an expression reads the memory, or passes it to a function."""
        parents = [part for part in ast.walk(node) if isinstance(part, (ast.Subscript, ast.Call))]
        inside = [
            part
            for parent in parents
            for part in (parent.args if isinstance(parent, ast.Call) else [parent.value])
        ]
        return any(isinstance(p, ast.Name) and self.types.get(p.id) == MEMORY for p in inside)

    def may_write_memory(self, node: ast.expr) -> bool:
        """Return whether evaluating an expression may change the memory."""
        calls = [part.func for part in ast.walk(node) if isinstance(part, ast.Call)]
        things = [resolve_name(self.module, ast.unparse(function)) for function in calls]
        return any(isinstance(thing, FunctionType) and writes_memory(thing) for thing in things)


def c_name(name: str) -> str:
    return f"{name}_" if name in TAKEN else name


def is_simple_name(value: Value) -> bool:
    return value.rank == ATOM and all(part.isidentifier() for part in value.text.split("."))
