# SPDX-License-Identifier: Apache-2.0
"""One look for all figures, and one way to save them."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import matplotlib
from matplotlib.figure import Figure

from condyle.whole_files import write_whole

#: Colour-blind safe (Okabe & Ito 2008): medial, lateral, total; reference solid, surrogate dashed.
COLOURS: Final = {"medial": "#0072B2", "lateral": "#D55E00", "total": "#222222"}
DOMAIN_COLOURS: Final = {
    1: "#D55E00",
    2: "#0072B2",
    3: "#009E73",
    4: "#E69F00",
    5: "#CC79A7",
    6: "#666666",
}
#: What was measured, as a shade behind what was computed.
MEASURED_COLOUR: Final = "#BDBDBD"
#: Of samples from elsewhere, which may know no domains.
OTHER_COLOUR: Final = "#0072B2"
#: Outcome of a candidate.
OUTCOME_COLOURS: Final = {
    "accepted": "#C8C8C8",
    "beyond_range": "#56B4E9",
    "non_compressive": "#0072B2",
    "no_equilibrium": "#E69F00",
    "overclosure": "#D55E00",
    "off_insert": "#009E73",
    "not_converged": "#000000",
    "in_contact": "#CC79A7",
}
#: Pressure from none (near white) to high.
PRESSURE_MAP: Final = "YlOrRd"

_SETTINGS: Final[dict[str, Any]] = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "legend.frameon": False,
    "figure.dpi": 110,
    "savefig.dpi": 150,
}


@contextmanager
def house_style() -> Iterator[None]:
    """Applies the look within a with-block, leaving the caller's matplotlib as it was."""
    with matplotlib.rc_context(_SETTINGS):
        yield


def save(figure: Figure, file: Path, dpi: float | None = None) -> Path:
    """Saves a figure as PNG, whole or not at all, without a date in it; ``dpi`` instead of the house's."""
    image = io.BytesIO()
    figure.savefig(
        image,
        format="png",
        dpi=dpi or matplotlib.rcParams["savefig.dpi"],
        metadata={"Software": None},
    )
    write_whole(file, image.getvalue())
    return file
