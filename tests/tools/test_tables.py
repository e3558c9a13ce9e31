"""Numbers in tables show the digits that their uncertainty leaves; tables are plain text or HTML."""

import math
import xml.etree.ElementTree as ET

import pytest

from exoid.tools.tables import WIDTH, DataTable, line_width, make_table, to_html, to_text, with_error


@pytest.mark.parametrize(
    ("value", "std", "written"),
    [
        (1.962817, 0.00131, ("1.9628", "0.0013")),
        (-0.00004, 0.5, ("-0.00", "0.50")),
        (123.456, 12.0, ("123", "12")),
        (123456.7, 2345.6, ("123457", "2346")),
        (0.5, 0.0999, ("0.500", "0.100")),
        (0.25, 1.5, ("0.2", "1.5")),
        (1.0, 3e-7, ("1.00000000", "0.00000030")),
        (1.23456789, 3e-12, ("1.23457", "3.0e-12")),
        (1.23456789, 0.0, ("1.23457", "0.0e+00")),
        (1.5, math.inf, ("1.5", "inf")),
        (1.5, math.nan, ("1.5", "nan")),
    ],
)
def test_a_value_is_written_to_the_second_digit_of_its_deviation(value, std, written):
    assert with_error(value, std) == written


def test_text_is_plain_and_fits():
    """Brackets and colons in names are no markup."""
    names = "[bold]x[/bold] :smile:", "[unit]", "[red]"
    text = to_text(names[0], make_table((names[1], "value"), [(names[2], "x" * 300)]), "word " * 100)
    assert all(name in text for name in names)
    assert "\033" not in text
    assert max(map(len, text.splitlines())) <= WIDTH
    assert not any(line.endswith(" ") for line in text.splitlines())


def test_a_table_in_html_has_the_caption_the_headers_and_the_cells():
    """Letter by letter: markup in them is escaped."""
    rows = [("<script>alert(1)</script>", "1.0"), ("b", "2.0")]
    table = ET.fromstring(to_html(DataTable('two & "rows" <i>', ("<b>", "value"), rows)))
    assert table.findtext("caption") == 'two & "rows" <i>'
    assert [cell.text for cell in table.findall("thead/tr/th")] == ["<b>", "value"]
    assert [tuple(cell.text for cell in row) for row in table.findall("tbody/tr")] == rows
    assert [cell.get("style") for cell in table.find("tbody/tr")] == ["text-align:left", "text-align:right"]


def test_a_table_at_60_columns_loses_no_letter_of_a_cell():
    headers = ("joint", "RMS [N·m]", "peak [N·m]", "mean [N·m]", "power [W]", "outside band", "p", "acts", "least")
    cells = ("left_ankle", "0.04134", "0.1274", "0.003155", "0.0003411", "3.8 %", "0.93", "no", "0.17")
    for width in (110, 80, 70, 60):
        token = line_width.set(width)
        try:
            text = to_text(make_table(headers, [cells]))
        finally:
            line_width.reset(token)
        assert max(map(len, text.splitlines())) <= width
        words = text.split()
        assert all(word in words for cell in (*headers, *cells) for word in cell.split())
