"""Executes the notebooks of docs/notebooks, each in its own kernel, and fails where a cell does.

usage: notebooks.py [--write]     --write puts what they print and draw into the files
"""
import pathlib
import sys

import nbformat
from nbclient import NotebookClient

home = pathlib.Path(__file__).resolve().parent.parent / "docs" / "notebooks"
for path in sorted(home.glob("*.ipynb")):
    notebook = nbformat.read(path, 4)
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(home)}}).execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        errors = [one for one in cell.get("outputs", []) if one.get("name") == "stderr"]
        if errors:
            sys.exit(f"{path.name}: {errors[0]['text']}")
    if "--write" in sys.argv[1:]:
        nbformat.write(notebook, path)
    print(path.name)
