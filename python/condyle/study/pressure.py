# SPDX-License-Identifier: Apache-2.0
"""Where the femur stands under the law that a study names for pressures."""

import numpy as np
from numpy.typing import NDArray

from condyle.errors import CondyleError
from condyle.study.context import StudyContext


def pressure_pose(
    context: StudyContext, pose: NDArray[np.float64], wrench: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The pose at which the contact under ``pressure_law`` carries the load of the reference contact.

    Another law makes another load at the same depth: pressures at the reference's pose would belong to no load that
    was applied. So the total Fy and Mx are kept, and y and θx found anew; x, z, θy, θz stay.

    Args:
        context: the study.
        pose: (6,) where the reference contact stands [m, rad].
        wrench: (2, 6) its loads there [N, Nm].

    Returns:
        (6,) the pose; the same one if the study names no ``pressure_law``.

    Raises:
        CondyleError: the law cannot carry the load.
    """
    if context.study.contact.pressure_law is None:
        return pose
    from condyle.fdk import solve_static_equilibria

    total = wrench.sum(axis=0)
    found = solve_static_equilibria(
        context.pressure_contact,
        pose[0],
        pose[2],
        pose[4],
        pose[5],
        total[1],
        total[3],
        start=[[pose[1], pose[3]]],
        threads=1,
    )
    if not found.converged[0]:
        raise CondyleError(
            f"contact.pressure_law ({context.pressure_contact.law_name()}): no pose carries "
            f"{total[1]:.0f} N and {total[3]:.2f} Nm: {found.status[0]}"
        )
    there: NDArray[np.float64] = found.poses[0]
    return there
