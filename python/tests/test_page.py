"""What can be pasted from the page on the module (docs/python.md) runs."""
import pathlib
import textwrap

import pytest

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


@pytest.mark.parametrize("title", ["**Fields of passages.**", "**Your own detectors.**"])
def test_what_a_section_shows_runs(title: str) -> None:
    pytest.importorskip("xarray")
    pytest.importorskip("matplotlib").use("agg")
    section = PAGE.read_text(encoding="utf-8").split(title)[1].split("\n**")[0]
    code = [line for line in section.splitlines() if line.startswith("    ") or not line]
    known: dict[str, object] = {}
    exec(compile(textwrap.dedent("\n".join(code)), title, "exec"), known)
    assert "run" in known
