# SPDX-License-Identifier: Apache-2.0
"""``python -m condyle.cli`` is the ``condyle`` command."""

from condyle.cli.app import main

main()
