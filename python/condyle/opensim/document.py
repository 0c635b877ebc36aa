# SPDX-License-Identifier: Apache-2.0
"""An .osim file as XML: what the library cannot read is taken out of it, and read here.

OpenSim-JAM's contact (Smith2018ContactMesh, Smith2018ArticularContactForce) is the case that
matters. Source of its fields: Smith, Vignos, Lenhart, Kaiser & Thelen 2016, J Biomech Eng 138:021017, and
OpenSim-JAM's sources.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from condyle.errors import InputDataError

CONTACT_MESH = "Smith2018ContactMesh"
CONTACT_FORCE = "Smith2018ArticularContactForce"
#: Classes of files before 4.0 that OpenSim has no more, and turns into others as it reads them.
_LEGACY = frozenset({"DisplayGeometry"})
#: Tags like <HuntCrossleyForce::ContactParameters>: no names in XML, so they have another one in between.
_SCOPED_TAG = re.compile(rb"(</?\w+)::")
_SCOPE = b".-."
_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)


@dataclass(frozen=True)
class RemovedComponent:
    """A component that the library does not know: its class, its name and its XML."""

    class_name: str
    name: str
    element: ElementTree.Element

    def text(self, tag: str, otherwise: str | None = None) -> str | None:
        """Text of a child element, stripped; ``otherwise`` where there is none."""
        found = self.element.findtext(tag)
        return otherwise if found is None else found.strip()


@dataclass
class Document:
    """The XML of an .osim file.

    Attributes:
        file: Where it is from.
        root: Its <OpenSimDocument>.
        removed: Components taken out by :meth:`remove_unknown`, in the file's order.
    """

    file: Path
    root: ElementTree.Element
    removed: list[RemovedComponent] = field(default_factory=list)

    @classmethod
    def read(cls, file: Path) -> Document:
        """Reads the XML of a model.

        Raises:
            InputDataError: No such file, no XML, or no OpenSim model in it.
        """
        try:
            # Comments are dropped: OpenSim takes some that XML forbids (with "--" inside).
            text = _COMMENT.sub(b"", file.read_bytes())
            root = ElementTree.fromstring(_SCOPED_TAG.sub(rb"\1" + _SCOPE, text))
        except OSError as error:
            raise InputDataError(f"{file}: cannot be read: {error.strerror or error}") from error
        except ElementTree.ParseError as error:
            raise InputDataError(f"{file}: not an OpenSim model: it is no XML ({error})") from error
        if root.tag != "OpenSimDocument" or root.find("Model") is None:
            raise InputDataError(
                f"{file}: not an OpenSim model: <{root.tag}> without <Model>, "
                "must be <OpenSimDocument> with a <Model>"
            )
        return cls(file, root)

    def remove_unknown(self, known: Callable[[str], bool]) -> None:
        """Takes components of unknown classes out of every <objects> and <components> list."""
        answers: dict[str, bool] = {}
        for parent in self.root.iter():
            if parent.tag not in ("objects", "components"):
                continue
            for child in list(parent):
                if child.tag not in answers:
                    answers[child.tag] = child.tag in _LEGACY or known(_own_name(child.tag))
                if not answers[child.tag]:
                    parent.remove(child)
                    name = child.get("name", "without a name")
                    self.removed.append(RemovedComponent(_own_name(child.tag), name, child))

    def removed_of(self, class_name: str) -> list[RemovedComponent]:
        """The components of one class that were taken out."""
        return [component for component in self.removed if component.class_name == class_name]

    def write(self, file: Path) -> None:
        """Writes what is left."""
        text = ElementTree.tostring(self.root, encoding="UTF-8", xml_declaration=True)
        file.write_bytes(text.replace(_SCOPE, b"::"))


def _own_name(tag: str) -> str:
    return tag.replace(_SCOPE.decode(), "::")
