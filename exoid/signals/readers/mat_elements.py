"""Check of the elements of a MATLAB file, because scipy's compiled reader crashes on inconsistent ones.

A file of version 5 to 7 is a header and elements. An element is a tag (type, size) and its content, padded to 8 bytes;
the tag itself may hold up to four bytes of content. A matrix is an element of elements: flags, dimensions, name, and
the content of its class.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

HEADER = 128
"""Bytes before the first element."""

TEXT = (1, 2, 4, 16, 17, 18)
"""Types of elements with characters: bytes, 16 bits, UTF-8, -16, -32."""

NUMBERS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13)
"""Types of elements with numbers."""

INT8, INT32, UINT32, MATRIX, COMPRESSED = 1, 5, 6, 14, 15

CELL, STRUCT, CHAR = 1, 2, 4
"""Classes of matrices."""

NUMERIC = range(6, 16)
"""Classes of numeric matrices, without sparse ones, objects and functions."""

COMPLEX = 1 << 11
"""Flag of a complex matrix."""

DEEPEST = 200
"""Largest nesting of matrices."""


class Element(NamedTuple):
    """One element."""

    kind: int  # type of the element
    content: memoryview  # content without tag and padding


class Matrix(NamedTuple):
    """A variable, or the content of a cell or a field."""

    name: str  # name of a variable; empty for others
    readable: bool  # whether it consists of numbers, text, cells and structs


def byte_order(data: bytes) -> str:
    """Tell the byte order as scipy does."""
    return "<" if data[126:128] == b"IM" else ">"


def expanded_size(data: bytes) -> int:
    """Sum the sizes that compressed elements declare."""
    place, total, order = HEADER, 0, byte_order(data)
    while place + 8 <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, place)
        if kind != COMPRESSED:
            return total
        tag = zlib.decompressobj().decompress(data[place + 8 : place + 8 + min(size, 4096)], 8)
        total += struct.unpack_from(f"{order}II", tag)[1] if len(tag) == 8 else 0
        place += 8 + size
    return total


def readable_variables(data: bytes) -> list[str] | None:
    """List the variables that consist of numbers, text, cells and structs."""
    if len(data) < HEADER or 0 in data[:4] or data[125 if data[126:127] == b"I" else 124] != 1:
        return None
    order = byte_order(data)
    found = [_matrix(element.content, order) for element in _variables(memoryview(data)[HEADER:], order)]
    unreadable = {variable.name for variable in found if not variable.readable}
    return [variable.name for variable in found if variable.name and variable.name not in unreadable]


def _variables(data: memoryview, order: str) -> Iterator[Element]:
    """Elements of the file, which are not padded, compressed or not."""
    place = 0
    while place < len(data):
        kind, size = _tag(data, place, order)
        content, place = _part(data, place + 8, size), place + 8 + size
        if kind == COMPRESSED:
            packed = zlib.decompressobj()
            kind, size = _tag(memoryview(packed.decompress(content, 8)), 0, order)
            content = _part(memoryview(packed.decompress(packed.unconsumed_tail, size + 1)), 0, size)
        if kind != MATRIX or not size:
            raise ValueError(f"a variable of type {kind} and {size} bytes")
        yield Element(kind, content)


def _elements(data: memoryview, order: str) -> Iterator[Element]:
    """Elements of a matrix."""
    place = 0
    while place < len(data):
        kind, size = _tag(data, place, order)
        short = kind >> 16
        if short > 4:
            raise ValueError(f"a tag that holds {short} bytes")
        if short:
            yield Element(kind & 0xFFFF, _part(data, place + 4, short))
            place += 8
        else:
            yield Element(kind, _part(data, place + 8, size))
            place += 8 + size + -size % 8


def _matrix(data: memoryview, order: str, depth: int = 0) -> Matrix:
    """Check a matrix and all of its content; raises ValueError for elements that its class does not have."""
    if depth > DEEPEST:
        raise ValueError(f"matrices lie more than {DEEPEST} deep in each other")
    if not data and depth:
        return Matrix("", readable=True)
    elements = _elements(data, order)
    flags, shape, name = next(elements, None), next(elements, None), next(elements, None)
    if flags is None or (flags.kind, len(flags.content)) != (UINT32, 8):
        raise ValueError("a variable without flags")
    bits = struct.unpack_from(f"{order}I", flags.content)[0]
    if bits & 0xFF not in (CELL, STRUCT, CHAR, *NUMERIC):
        return Matrix("" if name is None else str(bytes(name.content), "latin1"), readable=False)
    if shape is None or shape.kind not in (INT32, UINT32) or _is_no_shape(shape.content) or name is None:
        raise ValueError("a variable without dimensions or name")
    count = math.prod(_integers(shape.content, order))
    return Matrix(str(bytes(name.content), "latin1"), _has_class(bits, count, list(elements), order, depth))


def _has_class(bits: int, count: int, rest: list[Element], order: str, depth: int) -> bool:
    """Whether the content of a matrix can be read; raises ValueError for content that its class does not have."""
    kind = bits & 0xFF
    kinds = [element.kind for element in rest]
    if kind in NUMERIC and len(kinds) == 1 + bool(bits & COMPLEX) and set(kinds) <= set(NUMBERS):
        return True
    if kind == CHAR and len(kinds) == 1 and set(kinds) <= set(TEXT):
        return True
    if kind == STRUCT and kinds[:2] == [INT32, INT8] and len(rest[0].content) == 4:
        (length,), names = _integers(rest[0].content, order), len(rest[1].content)
        if length <= 0 or names % length:
            raise ValueError(f"fields of a struct with names of {length} characters in {names} bytes")
        count, rest, kinds = count * (names // length), rest[2:], kinds[2:]
    elif kind != CELL:
        raise ValueError(f"a variable of class {kind} of elements of types {kinds[:9]}")
    if kinds != [MATRIX] * len(kinds) or len(kinds) != count or any(len(element.content) % 8 for element in rest):
        raise ValueError(f"{len(kinds)} cells or fields where there should be {count}")
    return all(_matrix(element.content, order, depth + 1).readable for element in rest)


def _is_no_shape(content: memoryview) -> bool:
    """Tell whether bytes are not two or more dimensions; scipy's reader crashes on text without any."""
    return len(content) < 8 or len(content) % 4 != 0


def _integers(content: memoryview, order: str) -> tuple[int, ...]:
    return struct.unpack(f"{order}{len(content) // 4}i", content)


def _tag(data: memoryview, place: int, order: str) -> tuple[int, int]:
    kind, size = struct.unpack(f"{order}II", _part(data, place, 8))
    return int(kind), int(size)


def _part(data: memoryview, start: int, size: int) -> memoryview:
    if start + size > len(data):
        raise ValueError("it ends in the middle of a variable")
    return data[start : start + size]
