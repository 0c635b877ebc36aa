# SPDX-License-Identifier: Apache-2.0
"""Stage ``evaluate``: the surrogate file against held-out samples, and against itself in other runtimes."""

from pathlib import Path

import condyle
from condyle.evaluation import sample_error_table
from condyle.study.context import StudyContext


def run(context: StudyContext) -> bool:
    """Evaluates the ONNX file in the C++ runtime at the held-out samples, and checks parity between runtimes."""
    from condyle.contact import Derivatives
    from condyle.sampling import Dataset
    from condyle.surrogate import load_surrogate
    from condyle.surrogate.paper_errors import paper_comparison
    from condyle.surrogate.parity import runtime_differences

    inputs = {
        "surrogate": context.outputs_of("train"),
        "samples": context.outputs_of("sample"),
        "version": condyle.__version__,
    }

    def work() -> list[Path]:
        context.reporter.stage("evaluate", "held-out samples, parity")
        dataset = Dataset.read(context.samples_directory)
        test = dataset.split == "test"
        model = load_surrogate(context.directory.surrogate)
        loads = model.evaluate(dataset.poses[test], Derivatives.none, context.threads)
        rows = sample_error_table(dataset.domain[test], dataset.wrenches[test], loads.wrench)
        parity = runtime_differences(context.directory.surrogate, dataset.poses[test][:200])
        worst = min(
            r["loaded_r2"] for r in rows if r["domain"] == "all" and r["loaded_r2"] is not None
        )
        said = f"lowest R² of a load over loaded samples: {worst:.5f}"
        if comparison := paper_comparison(rows):
            above = sum(cell["above"] for cell in comparison)
            said += f"; {above} of {len(comparison)} errors above the paper's"
        context.reporter.finished("evaluate", said)
        return [
            context.directory.write_table("sample_errors", rows),
            context.directory.write_table("parity", parity),
        ]

    return context.directory.run_stage("evaluate", inputs, work)
