# SPDX-License-Identifier: Apache-2.0
"""The stages of a study, in order: implant, reference, sample, train, evaluate, simulate, report."""
