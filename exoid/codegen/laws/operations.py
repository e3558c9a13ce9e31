"""Operations of one step of a law in the worst case, counted in the C that was written."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from exoid.errors import ExoidError

from .syntax import Function, Node, functions_of

KINDS = {"+": "+ −", "-": "+ −", "+=": "+ −", "-=": "+ −", "*": "×", "*=": "×", "/": "÷", "/=": "÷"}
"""Kind of each operator on real numbers."""

COMPARISONS = frozenset({"<", ">", "<=", ">=", "==", "!="})

COMPARE = "compare"
"""Kind of comparisons, and of fabs, fmin, fmax and the like, which cost as much."""

CHEAP = frozenset({"fabs", "fmin", "fmax", "copysign", "isfinite"})

ENUMERATOR = re.compile(r"[A-Z][A-Z0-9_]*_[A-Z0-9_]+")
"""Names in capitals, which stand for integers."""

LONGEST_LOOP = 100_000


@dataclass(frozen=True)
class Operations:
    """Number of operations on real numbers, by kind.

    Operations on integers and indices, loads and stores do not count. Of two branches each kind counts as in the branch
    that has more of it; returns are ignored. So this is an upper bound for every input.

    Attributes:
        by_kind: Number of each kind: "+ −", "×", "÷", "compare", and functions of <math.h> by name.
    """

    by_kind: dict[str, int]

    def __str__(self) -> str:
        """List the kinds, arithmetic first."""
        first = ("+ −", "×", "÷")
        kinds = [*first, *sorted(kind for kind in self.by_kind if kind not in first)]
        return ", ".join(f"{self.by_kind.get(kind, 0)} {kind}" for kind in kinds)


def count_operations(source: str, header: str, function: str) -> Operations:
    """Count the operations of a function and of all that it calls.

    Args:
        source: The C file.
        header: Its header, for types, fields and constants.
        function: Name of the function.

    Returns:
        The number of operations of each kind.

    Raises:
        ExoidError: The file has syntax that exoid does not write, or a loop whose length is not known.
    """
    types = frozenset(re.findall(r"(?:\}|typedef \w+) (\w+);", header))
    texts = f"{header}\n{source}"
    constants = {name: int(value) for name, value in re.findall(r"^#define (\w+) (\d+)\b", texts, re.MULTILINE)}
    fields = frozenset(re.findall(r"^ *(?:int|uint32_t) (\w+);", header, re.MULTILINE))
    found = _File(functions_of(source, types), types, constants, fields)
    return Operations(dict(found.cost(function)))


class _Value:
    """Cost of an expression, whether it is an integer, and its value if that is known."""

    def __init__(self, cost: Counter[str], integer: bool, known: int | None = None) -> None:
        self.cost, self.integer, self.known = cost, integer, known


class _File:
    """Functions of a file with the names of its integers."""

    def __init__(
        self, functions: dict[str, Function], types: frozenset[str], constants: dict[str, int], fields: frozenset[str]
    ) -> None:
        self._functions, self._constants, self._fields = functions, constants, fields
        self._integer_types = {"int", "uint32_t", *(name for name in types if name.endswith("_status"))}
        self._costs: dict[tuple[str, tuple[int | None, ...]], Counter[str]] = {}

    def cost(self, name: str, arguments: tuple[int | None, ...] = ()) -> Counter[str]:
        """Cost of a call, with the values of its integer arguments as far as they are known."""
        if (name, arguments) not in self._costs:
            function = self._functions[name]
            integers: dict[str, int | None] = dict.fromkeys(function.integers)
            given = zip(function.names, arguments, strict=False)
            integers |= {each: value for each, value in given if each in function.integers}
            self._costs[name, arguments] = _Walk(self, integers).statements(function.body)
        return self._costs[name, arguments]

    def is_integer(self, kind: str) -> bool:
        """Whether a type of C is an integer."""
        return kind in self._integer_types

    def is_integer_field(self, name: str) -> bool:
        """Whether a field of a struct is an integer."""
        return name in self._fields

    def constant(self, name: str) -> int | None:
        """Value of an integer constant; None for any other name."""
        return self._constants.get(name)

    def returns_integer(self, name: str) -> bool:
        """Whether a function returns an integer."""
        return name in self._functions and self.is_integer(self._functions[name].returns)

    def __contains__(self, name: str) -> bool:
        return name in self._functions


class _Walk:
    """Walk through one call of a function, with its integer variables."""

    def __init__(self, file: _File, integers: dict[str, int | None]) -> None:
        self._file, self._integers = file, integers

    def statements(self, body: list[Node]) -> Counter[str]:
        """Count the operations of statements."""
        total: Counter[str] = Counter()
        for node in body:
            total += self._statement(node)
        return total

    def _statement(self, node: Node) -> Counter[str]:
        kind, *parts = node
        if kind == "declare":
            if self._file.is_integer(parts[0]):
                self._integers[parts[1]] = None
            return Counter()
        if kind == "do":
            return self._value(parts[0]).cost
        if kind == "if":
            condition = self._value(parts[0])
            if condition.known is not None:
                return condition.cost + self.statements(parts[1] if condition.known else parts[2])
            return condition.cost + (self.statements(parts[1]) | self.statements(parts[2]))
        start, condition, step, repeated = parts
        total = self._value(start).cost
        for _ in range(LONGEST_LOOP):
            test = self._value(condition)
            if test.known is None:
                break
            if not test.known:
                return total
            total += test.cost + self.statements(repeated) + self._value(step).cost
        raise ExoidError("a loop whose length is not known", remedy="loop over integers from one constant to another")

    def _value(self, node: Node) -> _Value:
        kind, *parts = node
        kinds: dict[str, Callable[..., _Value]] = {
            "number": _number,
            "name": self._name,
            "field": lambda name: _Value(Counter(), self._file.is_integer_field(name)),
            "[]": self._element,
            "call": self._call,
            "cast": self._cast,
            "?": self._choice,
        }
        if kind in kinds:
            return kinds[kind](*parts)
        if kind.endswith(" of"):
            return self._unary(kind.removesuffix(" of"), parts[0])
        return self._binary(kind, *parts)

    def _element(self, array: Node, index: Node) -> _Value:
        whole = self._value(array)
        return _Value(whole.cost + self._value(index).cost, whole.integer)

    def _cast(self, kind: str, operand: Node) -> _Value:
        inner = self._value(operand)
        return _Value(inner.cost, self._file.is_integer(kind), inner.known)

    def _name(self, name: str) -> _Value:
        if name in self._integers:
            return _Value(Counter(), True, self._integers[name])
        constant = self._file.constant(name)
        return _Value(Counter(), constant is not None or bool(ENUMERATOR.fullmatch(name)), constant)

    def _call(self, name: str, arguments: list[Node]) -> _Value:
        values = [self._value(argument) for argument in arguments]
        total = sum((value.cost for value in values), Counter[str]())
        if name in self._file:
            given = tuple(value.known if value.integer else None for value in values)
            return _Value(total + self._file.cost(name, given), self._file.returns_integer(name))
        plain = name.removesuffix("f") if name not in CHEAP and name.endswith("f") else name
        plain = "compare" if plain in CHEAP or plain.removesuffix("f") in CHEAP else plain
        return _Value(total + Counter([plain]), name == "isfinite")

    def _choice(self, condition: Node, then: Node, otherwise: Node) -> _Value:
        test, one, other = (self._value(node) for node in (condition, then, otherwise))
        if test.known is not None:
            chosen = one if test.known else other
            return _Value(test.cost + chosen.cost, chosen.integer, chosen.known)
        return _Value(test.cost + (one.cost | other.cost), one.integer and other.integer)

    def _unary(self, operator: str, operand: Node) -> _Value:
        value = self._value(operand)
        if operator in ("++", "--"):
            change = 1 if operator == "++" else -1
            if operand[0] == "name" and operand[1] in self._integers:
                value.known = None if value.known is None else value.known + change
                self._integers[operand[1]] = value.known
            return value
        if operator == "-":
            negated = operand[0] != "number" and not value.integer
            cost = value.cost + Counter(["+ −"]) if negated else value.cost
            return _Value(cost, value.integer, None if value.known is None else -value.known)
        if operator == "!":
            return _Value(value.cost, True, None if value.known is None else int(not value.known))
        return _Value(value.cost, value.integer and operator == "+", value.known if operator == "+" else None)

    def _binary(self, operator: str, left: Node, right: Node) -> _Value:
        one, other = self._value(left), self._value(right)
        integer, cost = one.integer and other.integer, one.cost + other.cost
        if operator == "=":
            if left[0] == "name" and left[1] in self._integers:
                self._integers[left[1]] = other.known
            return _Value(cost, one.integer)
        if operator in ("&&", "||"):
            return _Value(cost, True)
        if not integer:
            cost += Counter([COMPARE if operator in COMPARISONS else KINDS[operator]])
            return _Value(cost, operator in COMPARISONS)
        known = None
        if one.known is not None and other.known is not None:
            known = _of_integers(operator, one.known, other.known)
        return _Value(cost, True, known)


def _number(text: str) -> _Value:
    whole = text.isdigit()
    return _Value(Counter(), whole, int(text) if whole else None)


def _of_integers(operator: str, one: int, other: int) -> int | None:
    """Compute what a loop needs."""
    results = {
        "+": one + other,
        "-": one - other,
        "*": one * other,
        "<": int(one < other),
        ">": int(one > other),
        "<=": int(one <= other),
        ">=": int(one >= other),
        "==": int(one == other),
        "!=": int(one != other),
    }
    return results.get(operator)
