"""What goes into JSON comes out of it as it was."""

import json
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest

from exoid.tools.json_values import json_value


class Point(NamedTuple):
    x: float
    y: float


@dataclass(frozen=True)
class Line:
    ends: tuple[Point, Point]
    weights: np.ndarray
    label: str = "a"

    @property
    def count(self):
        return np.int64(len(self.ends))


LINE = Line((Point(0.0, 1.0), Point(2.0, np.inf)), np.array([[0.1, np.nan], [1.0, 2.0]]))


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        *((None, None), ("text", "text"), (np.True_, True), (np.int32(3), 3), (np.float64(0.1), 0.1)),
        *((float("inf"), None), (np.zeros((0, 2)), []), (np.array(5.0), 5.0), (range(3), [0, 1, 2])),
        ({"a": (1, 2.5), "b": {"c": np.array([True, False])}}, {"a": [1, 2.5], "b": {"c": [True, False]}}),
        (Point(1.0, -np.inf), {"x": 1.0, "y": None}),
    ],
)
def test_values_are_those_that_json_gives_back(value, expected):
    assert json_value(value) == expected
    assert json.loads(json.dumps(json_value(value), allow_nan=False)) == expected


def test_records_are_written_field_by_field_in_their_order():
    text = json.dumps(json_value(LINE), allow_nan=False)
    assert text == (
        '{"ends": [{"x": 0.0, "y": 1.0}, {"x": 2.0, "y": null}], "weights": [[0.1, null], [1.0, 2.0]], "label": "a"}'
    )


@pytest.mark.parametrize("value", [{1, 2}, object(), 1j, b"bytes", Line])
def test_other_kinds_are_refused(value):
    with pytest.raises(TypeError, match="no JSON for"):
        json_value(value)
