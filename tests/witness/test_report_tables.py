"""Tables of reports: aligned, 80 columns wide, numbers whole."""

from robotraj.witness.report_tables import WIDTH, shortened, table


def test_numbers_are_aligned_right_and_texts_left():
    assert table(("state", "error"), [("q.elbow", "1.0e-03"), ("q.a", "2")]) == [
        " state      error",
        " ────────────────",
        " q.elbow  1.0e-03",
        " q.a            2",
    ]


def test_a_table_that_is_too_wide_shortens_its_longest_texts_only():
    name, phase = "left_foot_of_the_machine", "a phase whose name is longer than anybody would think of"
    lines = table(("contact", "slip [m]", "phase"), [(name, "1.234e-05", phase)], texts=(0, 2))
    assert max(map(len, lines)) == WIDTH
    assert name in lines[-1] and "1.234e-05" in lines[-1] and lines[-1].endswith("think of")


def test_a_text_is_shortened_in_its_middle():
    assert shortened("double support, other side", 19) == "double su…ther side"
    assert shortened("stance", 19) == "stance"
