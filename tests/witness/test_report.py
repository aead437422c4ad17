"""Reports: one line by repr, 80 columns by str, colours on terminals, HTML in notebooks."""

import sys

import pytest

from robotraj.witness import validate


@pytest.fixture
def report(make, swinging):
    return validate(make.solution(swinging(name="swing & <turn>", limits=make.limits(2, velocity=[9.0, 2.9]))))


def test_its_representation_is_one_line(report):
    assert repr(report).startswith("<Report FAILED: local error ") and "1 violations" in repr(report)
    assert "\n" not in repr(report) and len(repr(report)) < 120


def test_the_verdict_is_last_and_coloured_on_a_terminal_alone(report, monkeypatch):
    assert str(report).splitlines()[-1].startswith("FAILED in ")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert str(report).splitlines()[-1].startswith("\x1b[31mFAILED\x1b[0m in ")
    assert "\x1b" not in str(report).splitlines()[0]
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in str(report)


def test_in_a_notebook_the_verdict_is_red_or_green_and_names_are_escaped(report, make, swinging):
    page = report._repr_html_()
    assert "#cf222e" in page and "swing &amp; &lt;turn&gt;" in page and "<turn>" not in page
    assert "#1a7f37" in validate(make.solution(swinging()))._repr_html_()


def test_a_breach_inside_the_tolerance_is_not_listed(make, swinging):
    # The peak is 3 rad/s: 1.5e-3 beyond a limit of 2.9985, a thousandth of which is allowed.
    near = validate(make.solution(swinging(limits=make.limits(2, velocity=[9.0, 2.9985]))))
    assert near.passed and near.violations == () and "none violated" in str(near)
    (breach,) = near.breaches
    assert breach.amount == pytest.approx(1.5e-3, abs=1e-4) and breach.size == pytest.approx(2.9985)
