# SPDX-License-Identifier: Apache-2.0
"""Studies: one TOML file, one run directory, stages that are skipped when nothing they depend on has changed."""

from condyle.study.read import read_study
from condyle.study.run import StudyRun
from condyle.study.run_directory import RunDirectory
from condyle.study.schema import Study

__all__ = ["RunDirectory", "Study", "StudyRun", "read_study"]
