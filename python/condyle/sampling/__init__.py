# SPDX-License-Identifier: Apache-2.0
"""Sampling a contact model: where to know it, and what the contact does there.

Reference curves say where the activities are; domains are regions around them, from which
candidates are drawn evenly; each candidate is a static equilibrium for a solver; the accepted ones
become a dataset of (pose, wrench) samples in Parquet. Use it whenever a surrogate is to be trained
for a contact model that can be evaluated.

    report = sample(SamplingPlan.preset("quick", seed=2017), curves, solver, directory, identity)
    train = Dataset.read(directory).select(split="train")

Reference: Marra MA et al. (2017), sampling of the reference contact model and Table 1.
"""

from condyle.sampling.curve_files import read_table, read_tables, write_csv
from condyle.sampling.dataset import Candidates, Dataset, read_candidates
from condyle.sampling.domain import DOMAIN_NAMES, PAPER_COUNTS, SamplingDomain
from condyle.sampling.domains import BoundaryPoints, DomainInputs, build_domain
from condyle.sampling.equilibrium_protocol import (
    GIVEN_COLUMNS,
    PRESCRIBED_COLUMNS,
    SOLVER_STATUSES,
    Prescribed,
    Solved,
    StaticEquilibriumSolver,
)
from condyle.sampling.external import TEST_SHARE, ImportReport, import_samples
from condyle.sampling.external_table import TableUnits
from condyle.sampling.outlines import Outline, domain_outlines
from condyle.sampling.plan import DomainTarget, SamplingPlan
from condyle.sampling.reference_curves import CURVE_COLUMNS, ReferenceCurve, ReferenceCurves
from condyle.sampling.report import DomainReport, Progress, SamplingProgress, SamplingReport
from condyle.sampling.sample import sample
from condyle.sampling.selection import keyed_hash

__all__ = [
    "CURVE_COLUMNS",
    "DOMAIN_NAMES",
    "GIVEN_COLUMNS",
    "PAPER_COUNTS",
    "PRESCRIBED_COLUMNS",
    "SOLVER_STATUSES",
    "TEST_SHARE",
    "BoundaryPoints",
    "Candidates",
    "Dataset",
    "DomainInputs",
    "DomainReport",
    "DomainTarget",
    "ImportReport",
    "Outline",
    "Prescribed",
    "Progress",
    "ReferenceCurve",
    "ReferenceCurves",
    "SamplingDomain",
    "SamplingPlan",
    "SamplingProgress",
    "SamplingReport",
    "Solved",
    "StaticEquilibriumSolver",
    "TableUnits",
    "build_domain",
    "domain_outlines",
    "import_samples",
    "keyed_hash",
    "read_candidates",
    "read_table",
    "read_tables",
    "sample",
    "write_csv",
]
