"""docs/tutorial.ipynb: a notebook that is one, whose cells run in order and show something, without Jupyter."""

import ast
import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOK = json.loads((ROOT / "docs/tutorial.ipynb").read_text(encoding="utf-8"))
CELLS = [cell for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]

RUNNER = """
import ast, json, sys
names = {"__name__": "__main__"}
for code in json.load(sys.stdin):
    *body, last = ast.parse(code).body
    shown = isinstance(last, ast.Expr) and not code.rstrip().endswith(";")
    exec(compile(ast.Module(body if shown else [*body, last], []), "cell", "exec"), names)
    if shown:
        value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
        drawn = [getattr(value, kind)() for kind in ("_repr_html_", "_repr_png_") if hasattr(value, kind)]
        print("SHOWN", type(value).__name__, max(len(data or "") for data in drawn or [repr(value)]))
"""
"""What a notebook does with its cells: all of them in one namespace, and the last expression of each is shown."""


def test_the_notebook_is_of_format_4_and_holds_no_outputs():
    assert set(NOTEBOOK) == {"cells", "metadata", "nbformat", "nbformat_minor"}
    assert NOTEBOOK["nbformat"] == 4 and NOTEBOOK["nbformat_minor"] == 4  # from 5 on cells need ids
    for cell in NOTEBOOK["cells"]:
        own = {"execution_count", "outputs"} if cell["cell_type"] == "code" else set()
        assert set(cell) == {"cell_type", "metadata", "source"} | own and cell["cell_type"] in ("code", "markdown")
        assert isinstance(cell["source"], list) and all(isinstance(line, str) for line in cell["source"])
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in CELLS)
    assert 6 <= len(CELLS) <= 10 and all(ast.parse("".join(cell["source"])) for cell in CELLS)


def test_links_of_the_notebook_lead_somewhere():
    text = "".join(line for cell in NOTEBOOK["cells"] for line in cell["source"])
    links = [part.partition(")")[0] for part in text.split("](")[1:]]
    assert len(links) > 2 and all((ROOT / "docs" / link).exists() for link in links)


def test_its_cells_run_in_order_in_a_fresh_python(tmp_path):
    codes = ["".join(cell["source"]) for cell in CELLS]
    if find_spec("pandas") is None:  # an extra
        codes = [code.replace(".to_frame().tail()", "[-5:]") for code in codes]
    done = subprocess.run(
        [sys.executable, "-c", RUNNER], input=json.dumps(codes), cwd=tmp_path, capture_output=True, text=True,
        timeout=300, env=os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]),
                                       "TMPDIR": str(tmp_path), "MPLBACKEND": "agg"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    said = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("SHOWN")]
    assert {"Result", "CurveFigure", "Image", "Movie"} <= {kind for kind, _ in said}
    sizes = {kind: int(size) for kind, size in said}
    assert sizes["Movie"] > 10_000 and sizes["CurveFigure"] > 10_000 and sizes["Image"] > 10_000
    assert "first failure at" in done.stdout and "cube_lab" in done.stdout
