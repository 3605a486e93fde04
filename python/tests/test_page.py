"""What can be pasted from the pages on the module (docs/python.md, docs/tutorials/python.md) runs."""
import pathlib
import textwrap

import pytest

DOCS = pathlib.Path(__file__).parents[2] / "docs"


def run_code(text: str, name: str) -> dict[str, object]:
    """Executes the code of a piece of a page, and returns what it names."""
    code = [line for line in text.splitlines() if line.startswith("    ") or not line]
    known: dict[str, object] = {}
    exec(compile(textwrap.dedent("\n".join(code)), name, "exec"), known)
    return known


@pytest.mark.parametrize("title", ["**Fields of passages.**", "**Your own detectors.**"])
def test_what_a_section_shows_runs(title: str) -> None:
    pytest.importorskip("xarray")
    pytest.importorskip("matplotlib").use("agg")
    page = (DOCS / "python.md").read_text(encoding="utf-8")
    assert "run" in run_code(page.split(title)[1].split("\n**")[0], title)


def test_the_loop_of_the_tutorial_ends_at_the_exact_value(capsys: pytest.CaptureFixture[str]) -> None:
    page = (DOCS / "tutorials" / "python.md").read_text(encoding="utf-8")
    known = run_code(page.split("**4. Solve from Python.**")[1], "the tutorial")
    middle = known["middle"]
    assert isinstance(middle, float) and abs(middle - 0.023663) < 2e-5
    assert "sd of x is 0.6 at a = 0.0236" in capsys.readouterr().out
