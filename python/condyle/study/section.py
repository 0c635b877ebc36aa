# SPDX-License-Identifier: Apache-2.0
"""What all tables of a study file have in common."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Section(BaseModel):
    """A table of the study file."""

    model_config = ConfigDict(extra="forbid", frozen=True)
