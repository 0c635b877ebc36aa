# SPDX-License-Identifier: Apache-2.0
"""Whether a surrogate knows what it does not know: coverage of its bounds, poses outside, a stress path.

    .venv/bin/python tests/benchmarks/trust_outside.py runs/NAME [POSES]

- Coverage: share of held-out samples within the 95 % bound, by side and load, where that side is loaded.
- False alarms: share of held-out samples with trust below 0.5, by domain.
- Outside: poses from the global domain's box with one or two of its axes twice or three times as long, put where they
  carry the box's load, or pushed 2 to 6 mm deep, or left where the equilibrium was lost; only those that a plane parts
  from all training samples (4 000 planes are tried), so none within their convex hull. Share with trust below 0.5.
- Stress path: a closed path that swings through 1.3 times the box; `hybrid` against the reference, share of loads
  beyond the bound.

Needs a run of the mesh contact with domain 2; for studies with the default contact law.
"""

import json
import sys
from pathlib import Path

import numpy as np

from condyle.contact import Derivatives, MeshContact
from condyle.fdk import StaticEquilibriumSolver
from condyle.sampling import Dataset
from condyle.surrogate import HybridContactModel, load_surrogate

FY = 1
DEEPEST = 6e-3


def main() -> None:
    """Prints the tables."""
    run, wanted = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 5000
    samples = Dataset.read(run / "samples")
    surrogate = load_surrogate(run / "surrogate.onnx")
    references = {depth: reference(run, samples, depth) for depth in (2e-3, DEEPEST)}
    held_out = samples.select(split="test")
    found = surrogate.evaluate(held_out.poses, Derivatives.none, 0)
    coverage(held_out, found)
    false_alarms(held_out, found)
    box = next(entry["definition"] for entry in samples.manifest["domains"] if entry["domain"] == 2)
    outside(samples, surrogate, references, box, wanted)
    stress_path(surrogate, references[2e-3], box)


def reference(run: Path, samples: Dataset, plausible_depth: float) -> MeshContact:
    law = samples.manifest["identity"]["contact_law"]
    return MeshContact.from_files(
        femur=run / "implant" / "femur.stl",
        insert_medial=run / "implant" / "insert_medial.stl",
        insert_lateral=run / "implant" / "insert_lateral.stl",
        units="m",
        side_of_body=samples.manifest["identity"]["side_of_body"],
        evaluation=law["evaluation"],
        field_spacing=law.get("field_spacing"),
        plausible_depth=plausible_depth,
        cache_directory=run / "cache",
    )


def coverage(held_out: Dataset, found) -> None:
    print("95 % bound: share of loaded held-out samples within it")
    print(f"{'side':8}" + "".join(f"{load:>8}" for load in ("Fx", "Fy", "Fz", "Mx", "My", "Mz")))
    inside = np.abs(found.wrench - held_out.wrenches) <= found.error
    for side, name in enumerate(("medial", "lateral")):
        loaded = held_out.wrenches[:, side, FY] > 0
        print(f"{name:8}" + "".join(f"{share:8.3f}" for share in inside[loaded, side].mean(axis=0)))


def false_alarms(held_out: Dataset, found) -> None:
    print("\nheld-out samples with trust < 0.5")
    for domain in np.unique(held_out.domain):
        rows = held_out.domain == domain
        print(f"domain {domain}: {np.mean(found.trust[rows] < 0.5):.2%} of {rows.sum()}")
    near = held_out.domain <= 4
    print(f"domains 1-4: {np.mean(found.trust[near] < 0.5):.2%} of {near.sum()}")


def outside(samples: Dataset, surrogate, references, box, wanted: int) -> None:
    generator = np.random.default_rng(4)
    values = scaled_box(box, 8 * wanted, generator)
    deep_model, model = references[DEEPEST], references[2e-3]
    solved = StaticEquilibriumSolver(deep_model).solve(
        values[:, 0],
        values[:, 2],
        values[:, 4],
        values[:, 5],
        np.maximum(values[:, 1], 1.0),
        values[:, 3],
    )
    converged = solved.status == "converged"
    pushed = solved.poses.copy()
    pushed[:, 1] -= generator.uniform(2e-3, DEEPEST, len(pushed))
    kinds = {
        "carrying the box's load, over 2 mm deep": solved.poses[converged],
        "pushed 2 to 6 mm deep": pushed[converged],
    }
    train = samples.select(split="train").poses
    print("\noutside: poses with trust < 0.5")
    flagged, total = 0, 0
    for name, poses in kinds.items():
        too_deep = np.asarray(model.evaluate(poses, Derivatives.none, 0).implausible_depth)
        deepest = np.asarray(deep_model.evaluate(poses, Derivatives.none, 0).implausible_depth)
        poses = poses[too_deep & ~deepest]
        flagged, total = tell(name, poses, train, surrogate, wanted // 3, flagged, total)
    # Beside the insert nothing touches, or only an edge: at the height of a pose that does.
    lost = solved.poses[solved.status != "converged"]
    flagged, total = tell(
        "equilibrium lost: off the insert or tilted off it",
        lost,
        train,
        surrogate,
        wanted // 3,
        flagged,
        total,
    )
    print(f"{'all':50} {flagged / total:8.2%} of {total}")


def tell(name, poses, train, surrogate, wanted, flagged, total):
    poses = poses[parted(poses, train)][:wanted]
    trust = surrogate.evaluate(poses, Derivatives.none, 0).trust
    print(f"{name:50} {np.mean(trust < 0.5):8.2%} of {len(poses)}")
    return flagged + int((trust < 0.5).sum()), total + len(poses)


def scaled_box(box, count: int, generator) -> np.ndarray:
    """Values (n, 6) of x, Fy, z, Mx, θy, θz; one or two axes at two or three times their length."""
    low, high = np.array(box["score_low"]), np.array(box["score_high"])
    middle, half = (low + high) / 2, (high - low) / 2
    stretch = np.ones((count, 6))
    for row in stretch:
        row[generator.permutation(6)[: generator.integers(1, 3)]] = generator.integers(2, 4)
    scores = middle + half * stretch * generator.uniform(-1, 1, (count, 6))
    values = np.array(box["mean"]) + np.array(box["scale"]) * (scores @ np.array(box["axes"]))
    # Beyond 120° of flexion and 15° of hyperextension nothing articulates; trust need not say so.
    return values[(values[:, 5] > np.radians(-120)) & (values[:, 5] < np.radians(15))]


def parted(poses: np.ndarray, train: np.ndarray) -> np.ndarray:
    """Whether one of 4 000 planes parts each pose from all training poses."""
    generator = np.random.default_rng(5)
    near = train[train[:, 1] < np.quantile(train[:, 1], 0.98)]
    root = np.linalg.inv(np.linalg.cholesky(np.cov(near.T)))
    directions = generator.normal(size=(4000, 6)) @ root
    result = np.zeros(len(poses), bool)
    for block in np.array_split(directions, 40):
        result |= (poses @ block.T > (train @ block.T).max(axis=0)).any(axis=1)
    return result


def stress_path(surrogate, model, box) -> None:
    time = np.linspace(0, 2 * np.pi, 4000, endpoint=False)[:, None]
    low, high = np.array(box["score_low"]), np.array(box["score_high"])
    turns, phases = np.array([1, 2, 3, 5, 7, 11]), np.array([0.0, 0.7, 1.9, 2.8, 3.9, 5.1])
    scores = (low + high) / 2 + 0.65 * (high - low) * np.sin(turns * time + phases)
    values = np.array(box["mean"]) + np.array(box["scale"]) * (scores @ np.array(box["axes"]))
    values = values[
        (values[:, 5] > np.radians(-120)) & (values[:, 5] < np.radians(15)) & (values[:, 1] > 0)
    ]
    solved = StaticEquilibriumSolver(model).solve(
        values[:, 0], values[:, 2], values[:, 4], values[:, 5], values[:, 1], values[:, 3]
    )
    poses = solved.poses[solved.status == "converged"]
    hybrid = HybridContactModel(surrogate, model)
    truth = np.asarray(model.evaluate(poses, Derivatives.none, 0).wrench)
    found = hybrid.evaluate(poses, Derivatives.none, 0)
    bound = np.asarray(surrogate.evaluate(poses, Derivatives.none, 0).error)
    referred = np.asarray(surrogate.evaluate(poses, Derivatives.none, 0).trust) < 0.75
    loaded = truth[:, :, FY] > 0
    beyond = (np.abs(found.wrench - truth) > bound)[loaded]
    mine = loaded & ~referred[:, None]
    own = (np.abs(np.asarray(found.wrench) - truth) > bound)[mine]
    print(
        f"\nstress path: {len(poses)} poses, {referred.mean():.1%} by the reference or blended with it"
    )
    print(
        f"loads beyond their bound: {beyond.mean():.2%} of hybrid's, {own.mean():.2%} of the surrogate's own among them"
    )
    print(json.dumps({"worst share of one load": float(beyond.mean(axis=0).max())}))


if __name__ == "__main__":
    main()
