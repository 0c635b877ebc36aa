# SPDX-License-Identifier: Apache-2.0
import pytest

from condyle.errors import InputDataError
from condyle.opensim.document import Document

OLD = """<?xml version="1.0"?>
<OpenSimDocument Version="30000"><Model name="old">
<!-- a comment -- that XML forbids -->
<GeometrySet><objects><DisplayGeometry/><Known name="kept"/><Strange name="s1"><x> 3 </x></Strange>
</objects></GeometrySet>
<Contact::Parameters name="p"><objects><Contact::Point name="q"/><Strange::Point/></objects></Contact::Parameters>
</Model></OpenSimDocument>"""


def test_what_the_library_does_not_know_is_taken_out_and_kept_aside(tmp_path):
    file = tmp_path / "old.osim"
    file.write_text(OLD, encoding="utf-8")
    document = Document.read(file)
    document.remove_unknown(lambda name: name in ("Known", "Contact::Point"))
    names = [(removed.class_name, removed.name) for removed in document.removed]
    assert names == [("Strange", "s1"), ("Strange::Point", "without a name")]
    (strange,) = document.removed_of("Strange")
    assert (strange.text("x"), strange.text("y"), strange.text("y", "4")) == ("3", None, "4")
    document.write(tmp_path / "new.osim")
    text = (tmp_path / "new.osim").read_text(encoding="utf-8")
    assert "Strange" not in text
    for kept in (
        "<DisplayGeometry",
        '<Known name="kept"',
        '<Contact::Point name="q"',
        "</Contact::Parameters>",
    ):
        assert kept in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "cannot be read"),
        ("a,b", "it is no XML"),
        ("<OpenSimDocument/>", "without <Model>"),
    ],
)
def test_what_is_no_model_is_refused(tmp_path, text, words):
    file = tmp_path / "model.osim"
    if text is not None:
        file.write_text(text, encoding="utf-8")
    with pytest.raises(InputDataError, match=words):
        Document.read(file)
