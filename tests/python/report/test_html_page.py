# SPDX-License-Identifier: Apache-2.0
"""One page of a report: whole in itself, well-formed, with its figures in it and its numbers in line."""

import base64
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from condyle.errors import InputDataError
from condyle.report.html_page import html_page

#: The smallest PNG there is: one grey pixel.
PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg=="
)
REPORT = """# A knee & <more>

## Loads: `fast`, N

| side | Fy [N] | RMSE (maximum) | My | poses | note |
|---|---|---|---|---|---|
| medial | 1 204 | **3.2** (**11**) | 0.02 (–) | – | 20–60 N |
| lateral | -8.5e-03 | 0.25 (4) | **0.04** (0.1) | 400 | 2 global |
|  | ≥ 3.5 | 816 (13.6 min) |  | 12 | all |

## Figures

![gait_loads](figures/gait_loads.png)

![gait](figures/gait.png)
"""
XHTML = "{http://www.w3.org/1999/xhtml}"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "figures").mkdir()
    for name in ("gait_loads", "gait"):
        (tmp_path / "figures" / f"{name}.png").write_bytes(PIXEL)
    return tmp_path


def parsed(page: str) -> ElementTree.Element:
    """The page's tree; fails where the page is not well-formed."""
    assert page.startswith("<!DOCTYPE html>\n")
    return ElementTree.fromstring(page)


def find(page: str, tag: str) -> list[ElementTree.Element]:
    return list(parsed(page).iter(XHTML + tag))


def text(element: ElementTree.Element) -> str:
    return "".join(element.itertext())


def test_figures_are_in_the_page_byte_for_byte(folder):
    images = find(html_page(REPORT, "knee", folder), "img")
    assert [image.get("alt") for image in images] == ["gait_loads", "gait"]
    for image in images:
        head, data = image.get("src").split(",")
        assert head == "data:image/png;base64"
        assert base64.b64decode(data, validate=True) == PIXEL
    page = html_page(REPORT, "knee", folder)
    assert [text(caption) for caption in find(page, "figcaption")] == ["gait loads", "gait"]
    assert [len(list(figure)) for figure in find(page, "figure")] == [2, 2]


def test_the_page_needs_and_names_nothing_outside_itself(folder):
    page = html_page(REPORT, "knee", folder)
    links = [e.get(k) for e in parsed(page).iter() for k in ("href", "src") if e.get(k) is not None]
    assert links
    assert all(link.startswith(("#", "data:")) for link in links)
    assert str(folder) not in page
    assert "url(" not in page and "@import" not in page
    assert not find(page, "script") and not find(page, "link")


def test_every_chapter_is_in_the_contents_and_leads_there(folder):
    page = html_page(REPORT, "knee", folder)
    tree = parsed(page)
    contents = tree.find(f".//{XHTML}nav")
    entries = {a.get("href"): text(a) for a in contents.iter(XHTML + "a")}
    chapters = tree.find(f".//{XHTML}main").iter(XHTML + "h2")
    assert entries == {f"#{h.get('id')}": text(h) for h in chapters}
    assert list(entries.values()) == ["Loads: fast, N", "Figures"]
    assert not find(html_page("# A\n\n## Only one\n", "knee", folder), "nav")


def test_numbers_stand_on_the_right_and_words_on_the_left(folder):
    page = html_page(REPORT, "knee", folder)
    heads = {text(head): head.get("class") for head in find(page, "th")}
    assert heads == {
        "side": None,
        "Fy [N]": "number",
        "RMSE (maximum)": "number",
        "My": "number",
        "poses": "number",
        "note": None,
    }
    for row in find(page, "tr")[1:]:
        assert [cell.get("class") for cell in row] == [None, *4 * ["number"], None]
    assert [text(cell) for cell in find(page, "tr")[1]][2] == "3.2 (11)"
    assert "th.number, td.number { text-align: right; }" in page
    assert re.search(r"\nth \{ position: sticky; top: 0;", page)


def test_what_looks_like_html_is_shown_and_not_obeyed(folder):
    page = html_page("# <script>alert(1)</script>\n\n<b>x</b> a & b\n", "a < b & c", folder)
    assert not find(page, "script") and not find(page, "b")
    assert text(find(page, "h1")[0]) == "<script>alert(1)</script>"
    assert text(find(page, "title")[0]) == "a < b & c"


def test_the_same_report_gives_the_same_bytes(folder):
    assert html_page(REPORT, "knee", folder) == html_page(REPORT, "knee", folder)


@pytest.mark.parametrize(
    ("link", "message"),
    [
        ("figures/none.png", r"figure 'figures/none.png' in .*: No such file or directory"),
        ("figures/gait.pdf", r"figure 'figures/gait.pdf': must end in .png, .svg, .jpg"),
        ("../outside.png", r"figure '../outside.png': must be below "),
    ],
)
def test_a_figure_that_cannot_be_had_is_named(folder, link, message):
    (folder.parent / "outside.png").write_bytes(PIXEL)
    with pytest.raises(InputDataError, match=message):
        html_page(f"![x]({link})\n", "knee", folder)
