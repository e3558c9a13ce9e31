"""Syntax of the C that exoid writes: functions, loops over integers, conditions and expressions, as nested tuples."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, NamedTuple

from exoid.errors import ExoidError

TOKEN = re.compile(
    r"[A-Za-z_]\w*|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[fFuUlL]*"
    r'|->|\+\+|--|[-+*/%<>=!]=|&&|\|\||"[^"]*"|[-+*/%<>=!&|^~?:;,.(){}\[\]]'
)

LEVELS = (("||",), ("&&",), ("==", "!="), ("<", ">", "<=", ">="), ("+", "-"), ("*", "/", "%"))
"""Operators of two operands, weakest first."""

QUALIFIERS = frozenset({"const", "static"})

Node = tuple[Any, ...]
"""Statement or expression: its kind and its parts."""


class Function(NamedTuple):
    """Function of a C file."""

    returns: str  # type of its result
    integers: frozenset[str]  # names of its integer parameters
    names: tuple[str, ...]  # names of all parameters in order
    body: list[Node]  # statements


def functions_of(source: str, types: frozenset[str]) -> dict[str, Function]:
    """Read the functions of a C file."""
    return _Parser(_tokens(source), types | {"int", "void", "uint32_t", "double", "float"}).functions()


def _tokens(source: str) -> list[str]:
    plain = re.sub(r"/\*.*?\*/|^\s*#.*?$", " ", source, flags=re.DOTALL | re.MULTILINE)
    return TOKEN.findall(plain)


class _Parser:
    """Recursive descent over the tokens."""

    def __init__(self, tokens: list[str], types: frozenset[str]) -> None:
        self._tokens, self._types, self._at = [*tokens, "", ""], types, 0

    def functions(self) -> dict[str, Function]:
        """Parse all functions of the source, by name."""
        found = {}
        while self._here:
            while self._here in QUALIFIERS:
                self._next()
            returns, name = self._next(), self._next()
            if self._here == "(":
                names, integers = self._parameters()
                if not self._take(";"):
                    found[name] = Function(returns, integers, names, self._block())
            else:
                self._skip_to(";")
        return found

    @property
    def _here(self) -> str:
        return self._tokens[self._at]

    def _next(self) -> str:
        self._at += 1
        return self._tokens[self._at - 1]

    def _take(self, token: str) -> bool:
        found = self._here == token
        self._at += found
        return found

    def _expect(self, token: str) -> None:
        if not self._take(token):
            near = " ".join(self._tokens[max(0, self._at - 8) : self._at + 4])
            raise ExoidError(
                f"no {token!r} near {near!r}: the operations of this C cannot be counted",
                remedy="write steps with for loops over integers, if, ?: and expressions",
            )

    def _skip_to(self, end: str) -> None:
        depth = 0
        while depth or self._here != end:
            depth += (self._here in "({[") - (self._here in ")}]") if self._here else 0
            if not self._next():
                self._expect(end)
        self._next()

    def _parameters(self) -> tuple[tuple[str, ...], frozenset[str]]:
        self._expect("(")
        names, integers, words = [], set(), list[str]()
        while self._here != ")":
            token = self._next()
            if token == "[":
                self._skip_to("]")
            elif token == ",":
                words = []
            else:
                words.append(token)
            if self._here in (",", ")") and words and words[-1] != "void":
                names.append(words[-1])
                if words[0] in ("int", "uint32_t"):
                    integers.add(words[-1])
        self._next()
        return tuple(names), frozenset(integers)

    def _block(self) -> list[Node]:
        self._expect("{")
        body: list[Node] = []
        while not self._take("}"):
            body += self._statement()
        return body

    def _statement(self) -> list[Node]:
        if self._here == "{":
            return self._block()
        if self._here in self._types or self._here in QUALIFIERS:
            return self._declaration()
        if self._take("for"):
            return [("for", *self._head(";", ";", ")"), self._statement())]
        if self._take("if"):
            condition, then = *self._head(")"), self._statement()
            return [("if", condition, then, self._statement() if self._take("else") else [])]
        if self._take("return") and self._take(";"):
            return []
        value = self._expression()
        self._expect(";")
        return [("do", value)]

    def _head(self, *ends: str) -> list[Node]:
        """Expressions in the parentheses after for or if."""
        self._expect("(")
        found = []
        for end in ends:
            found.append(self._expression())
            self._expect(end)
        return found

    def _declaration(self) -> list[Node]:
        while self._here in QUALIFIERS:
            self._next()
        kind, found = self._next(), list[Node]()
        while True:
            self._take("*")
            name = self._next()
            while self._take("["):
                self._skip_to("]")
            found.append(("declare", kind, name))
            if self._take("="):
                found.append(("do", ("=", ("name", name), self._ternary())))
            if self._take(";"):
                return found
            self._expect(",")

    def _expression(self) -> Node:
        value = self._ternary()
        if self._here in ("=", "+=", "-=", "*=", "/="):
            return (self._next(), value, self._expression())
        return value

    def _ternary(self) -> Node:
        condition = self._binary(0)
        if not self._take("?"):
            return condition
        then = self._ternary()
        self._expect(":")
        return ("?", condition, then, self._ternary())

    def _binary(self, level: int) -> Node:
        if level == len(LEVELS):
            return self._unary()
        left = self._binary(level + 1)
        while self._here in LEVELS[level]:
            left = (self._next(), left, self._binary(level + 1))
        return left

    def _unary(self) -> Node:
        if self._here in ("-", "+", "!", "&", "*", "++", "--"):
            return (f"{self._next()} of", self._unary())
        if self._here == "(" and self._tokens[self._at + 1] in self._types:
            self._next()
            kind = self._next()
            self._expect(")")
            return ("cast", kind, self._unary())
        return self._postfix()

    def _postfix(self) -> Node:
        value: Node
        if self._take("("):
            value = self._expression()
            self._expect(")")
        elif self._here[:1].isdigit() or self._here[:1] == ".":
            value = ("number", self._next())
        elif re.match(r"[A-Za-z_]", self._here):
            value = ("name", self._next())
        else:
            self._expect("an expression")
        while True:
            if self._take("["):
                value = ("[]", value, self._expression())
                self._expect("]")
            elif self._here in ("->", "."):
                self._next()
                value = ("field", self._next())
            elif self._take("("):
                value = ("call", value[1], self._arguments(self._expression))
            else:
                return value

    def _arguments(self, read: Callable[[], Node]) -> list[Node]:
        found: list[Node] = []
        while not self._take(")"):
            found.append(read())
            self._take(",")
        return found
