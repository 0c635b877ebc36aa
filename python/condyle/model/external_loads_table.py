# SPDX-License-Identifier: Apache-2.0
"""The table beside an external-loads file, for records of what results come from."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path


def external_loads_table(file: Path | None) -> Path | None:
    """The table that OpenSim's external-loads file names.

    Args:
        file: XML; None: no loads.

    Returns:
        The table; None where the file names none that is there, or is none itself: whoever reads it for its loads
        says what is wrong with it.
    """
    if file is None:
        return None
    try:
        named = ElementTree.parse(file).findtext(".//datafile")
    except (OSError, ElementTree.ParseError):
        return None
    table = None if named is None else file.parent / named.strip()
    return table if table is not None and table.is_file() else None
