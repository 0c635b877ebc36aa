# SPDX-License-Identifier: Apache-2.0
"""Tables and figures of a run. Figures need matplotlib (``pip install 'condyle[report]'``)."""

from condyle.report.tables import render_tables

__all__ = ["render_tables"]
