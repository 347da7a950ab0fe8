"""A notebook, where many users work."""

import pytest

CELLS = (
    "import orchestrate\nown = orchestrate.Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3)",
    "found = orchestrate.map(own, eta=[0.6, 0.7, 0.8, 1.0], e=[0.3, 0.5, 0.7, 0.8], jobs=2,\n"
    "                        transient=300)\nfound.xi_rel_max",
    "motion = orchestrate.simulate(own, frequency=80.0, amplitude=1e-3, periods=5)",
    "%matplotlib inline\nimport matplotlib\nmatplotlib.get_backend()",
    "from orchestrate.show.lines import draw_sweep as draw\n"
    "figure = draw(orchestrate.sweep(own, eta=[1.0, 1.1], transient=50, samples=20))",
    "motion.x1.plot();",
)


@pytest.mark.slow
def test_a_notebook(exported, tmp_path):
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in CELLS])
    client = nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    shown = [output.get("data", {}) for output in notebook.cells[-1].outputs]
    assert any("image/png" in data for data in shown)  # our drawing has left the backend alone
    assert "text/html" in notebook.cells[1].outputs[-1]["data"]  # the dataset shows itself
