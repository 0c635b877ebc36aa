# SPDX-License-Identifier: Apache-2.0
"""Condyle: knee-replacement contact, quasi-static equilibrium and neural surrogates of the contact model.

Each capability is a module: :mod:`condyle.implants`, :mod:`condyle.contact`, :mod:`condyle.sampling`,
:mod:`condyle.training` (needs torch), :mod:`condyle.surrogate`, :mod:`condyle.fdk`, :mod:`condyle.activities`,
:mod:`condyle.evaluation`, :mod:`condyle.report`, :mod:`condyle.study`, and the ``condyle`` command.
Importing this package imports none of them.
"""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("condyle")
except PackageNotFoundError:  # run from a checkout without an installation
    __version__ = "0+unknown"

__all__ = ["__version__"]
