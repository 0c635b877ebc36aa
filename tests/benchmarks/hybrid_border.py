# SPDX-License-Identifier: Apache-2.0
"""Whether a hybrid finds equilibrium where trust ends: with the border of the sampled domains moved into trials.

    .venv/bin/python tests/benchmarks/hybrid_border.py SURROGATE.onnx

Subject DM, four trials (CONDYLE_DATA, or shared/data beside the project; needs `opensim` for the first run). The
file says up to which m a pose is in the sampled domains (:mod:`condyle.training.trust`); copies of it put that edge at
0.75 to 0.30 of the domains' half widths, so that trust passes 0.5 in the middle of the trials.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
import onnx
from dm_trial import CACHE, MUSCLES, dm_contacts, read_dm_trial

from condyle.fdk import simulate_trial
from condyle.surrogate import HybridContactModel, describe

#: Trials and their windows [s], as in docs/examples/dm_trials.toml.
TRIALS = {
    "DM_ngait_og1": (2.0, 3.5),
    "DM_bouncy5": (1.5, 3.05),
    "DM_smooth1": (2.15, 3.7),
    "DM_crouch_tm1": (1.428, 5.8),
}
EDGES = np.arange(0.75, 0.29, -0.05)
LEVEL = "trust.level"


def main() -> None:
    """Prints a row a trial and edge."""
    parser = argparse.ArgumentParser()
    parser.add_argument("surrogate", type=Path)
    parser.add_argument("--cache", type=Path, default=CACHE)
    options = parser.parse_args()
    subjects = {
        name: read_dm_trial(name, *window, options.cache) for name, window in TRIALS.items()
    }
    print(
        "| edge | trial | not in equilibrium | Newton steps | evaluations | by the reference or blended |"
    )
    print("|---|---|---|---|---|---|")
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for edge in EDGES:
            file = with_edge(options.surrogate, float(edge), Path(folder) / "moved.onnx")
            for name, subject in subjects.items():
                contacts = dm_contacts(subject, "hybrid", file)
                hybrid = contacts[0].model
                assert isinstance(hybrid, HybridContactModel)
                found = simulate_trial(subject.model, subject.trial, contacts, MUSCLES)
                failed += found.not_converged
                records = found.records
                print(
                    f"| {edge:.2f} | {name} | {found.not_converged}/{len(records)} | "
                    f"{sum(r.iterations for r in records)} | {sum(r.evaluations for r in records)} | "
                    f"{hybrid.reference_calls} |"
                )
    print(f"\nnot in equilibrium: {failed}")


def with_edge(surrogate: Path, edge: float, copy: Path) -> Path:
    """A copy of the file whose domains end at `edge`."""
    bounds = describe(surrogate)["domain_bounds"]
    bounds = json.loads(bounds) if isinstance(bounds, str) else bounds
    model = onnx.load(surrogate)
    (level,) = [tensor for tensor in model.graph.initializer if tensor.name == LEVEL]
    moved = onnx.numpy_helper.to_array(level) - (bounds["edge"] - edge) / (2 * bounds["ramp"])
    level.CopyFrom(onnx.numpy_helper.from_array(moved, LEVEL))
    onnx.save(model, copy)
    return copy


if __name__ == "__main__":
    main()
