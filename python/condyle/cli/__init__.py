# SPDX-License-Identifier: Apache-2.0
"""The ``condyle`` command: stages of a study (``condyle run STUDY.toml``) and tools (``condyle contact eval``)."""

from condyle.cli.app import main

__all__ = ["main"]
