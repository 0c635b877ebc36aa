# SPDX-License-Identifier: Apache-2.0
"""Condyle's exceptions.

Every mistake a caller can make raises :class:`InputDataError` (or the C++ core's ``ValueError``)
with the file, the field, the value and the limit in one line. Numerics that did not work out are
never an exception: they are a status in a result.
"""


class CondyleError(Exception):
    """Base of all exceptions that Condyle raises on purpose."""


class InputDataError(CondyleError, ValueError):
    """An input (file, array, setting) cannot be used; the message names it and says why."""
