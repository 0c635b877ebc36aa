# SPDX-License-Identifier: Apache-2.0
"""How far one contact model's answers are from another's: over samples, and over simulated activities."""

from condyle.evaluation.metrics import ErrorStatistics, error_statistics
from condyle.evaluation.paper_activities import activity_comparison, paper_activity
from condyle.evaluation.sample_errors import sample_error_table
from condyle.evaluation.simulation_errors import (
    KINEMATICS,
    kinematics_error_table,
    simulation_load_error_table,
)

__all__ = [
    "KINEMATICS",
    "ErrorStatistics",
    "activity_comparison",
    "error_statistics",
    "kinematics_error_table",
    "paper_activity",
    "sample_error_table",
    "simulation_load_error_table",
]
