# SPDX-License-Identifier: Apache-2.0
"""A report as one HTML page that can be mailed: made from its Markdown, with the figures inside it.

The page needs nothing but itself: figures are data URIs, the stylesheet is in its head, there is no script. It is
well-formed XML too, so any tool can read the tables out of it.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator, Sequence
from html import escape
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Final

from markdown_it import MarkdownIt
from markdown_it.token import Token

import condyle
from condyle.errors import InputDataError

#: What figures may be, by ending.
_IMAGE_TYPES: Final = {".png": "image/png", ".svg": "image/svg+xml", ".jpg": "image/jpeg"}
#: A number, maybe with what belongs to it: ``1.2e-5``, ``0.25 (0.31)``, ``0.02 (–)``, ``4 450 ms``, ``50.0 %``, ``3×``.
_NUMBER: Final = re.compile(
    r"[<>≤≥≈±+−-]?\s?\d[\d.,\s]*(e[+−-]?\d+)?\s?(%|×|[A-Za-zµ°²³/]{1,6})?(\s?\((–|.*\d.*)\))?"
)
#: Stands for a value that is not there.
_ABSENT: Final = {"", "–", "-", "nan"}


def html_page(markdown: str, title: str, folder: Path) -> str:
    """The page of a Markdown report.

    Args:
        markdown: CommonMark with tables; HTML in it is shown, not obeyed.
        title: of the window and of what a browser saves.
        folder: that the report's links to figures start from.

    Returns:
        The page's text; the same bytes for the same report and figures.

    Raises:
        InputDataError: a figure is missing, is of an unknown kind, or is not below ``folder``.
    """
    parser = MarkdownIt("commonmark", {"html": False, "xhtmlOut": True}).enable("table")
    tokens = parser.parse(markdown)
    chapters = _name_chapters(tokens)
    _align_numbers(tokens)
    _embed_figures(tokens, folder)
    # The title before the contents, which stand beside all else where there is room.
    titled = 3 if tokens and tokens[0].tag == "h1" else 0
    header, body = (
        parser.renderer.render(part, parser.options, {})
        for part in (tokens[:titled], _framed(tokens[titled:]))
    )
    style = files("condyle.report").joinpath("html_page.css").read_text(encoding="utf-8")
    return (
        '<!DOCTYPE html>\n<html xmlns="http://www.w3.org/1999/xhtml" lang="en">\n<head>\n<meta charset="utf-8" />\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1" />\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        f'<div class="page">\n<header>\n{header}</header>\n{_contents(chapters)}<main>\n{body}'
        f"<footer>Made by Condyle {escape(condyle.__version__)}.</footer>\n</main>\n</div>\n</body>\n</html>\n"
    )


def _name_chapters(tokens: Sequence[Token]) -> list[tuple[str, str]]:
    """Gives every second-level heading an anchor; (anchor, heading as HTML text)."""
    chapters: list[tuple[str, str]] = []
    for token, inside in pairwise(tokens):
        if token.type == "heading_open" and token.tag == "h2":
            anchor = f"chapter-{len(chapters) + 1}"
            token.attrSet("id", anchor)
            text = "".join(child.content for child in inside.children or ())
            chapters.append((anchor, escape(text)))
    return chapters


def _contents(chapters: Sequence[tuple[str, str]]) -> str:
    """The table of contents; none where there is nothing to choose from."""
    if len(chapters) < 2:
        return ""
    lines = "".join(f'<li><a href="#{anchor}">{text}</a></li>\n' for anchor, text in chapters)
    return f"<nav>\n<h2>Contents</h2>\n<ol>\n{lines}</ol>\n</nav>\n"


def _align_numbers(tokens: Sequence[Token]) -> None:
    """Marks the columns that hold nothing but numbers, heading included."""
    for table in _tables(tokens):
        rows: list[list[tuple[Token, str]]] = []
        for token, inside in pairwise(table):
            if token.type == "tr_open":
                rows.append([])
            elif token.type in ("th_open", "td_open"):
                rows[-1].append((token, _plain(inside)))
        for column in zip(*rows, strict=True):
            cells = [text for _, text in column[1:] if text not in _ABSENT]
            if cells and all(_NUMBER.fullmatch(text) for text in cells):
                for token, _ in column:
                    token.attrSet("class", "number")


def _tables(tokens: Sequence[Token]) -> Iterator[Sequence[Token]]:
    """The tokens of each table."""
    start = 0
    for i, token in enumerate(tokens):
        if token.type == "table_open":
            start = i
        elif token.type == "table_close":
            yield tokens[start : i + 1]


def _plain(inline: Token) -> str:
    """A cell's text without its markup."""
    return "".join(child.content for child in inline.children or ()).strip()


def _embed_figures(tokens: Sequence[Token], folder: Path) -> None:
    """Puts the files that images link to into the page."""
    for token in tokens:
        for child in token.children or ():
            if child.type == "image":
                child.attrSet("src", _data_uri(str(child.attrGet("src")), folder))


def _data_uri(link: str, folder: Path) -> str:
    file = folder / link
    kind = _IMAGE_TYPES.get(file.suffix.lower())
    if kind is None:
        raise InputDataError(f"figure {link!r}: must end in {', '.join(_IMAGE_TYPES)}")
    if not file.resolve().is_relative_to(folder.resolve()):
        raise InputDataError(f"figure {link!r}: must be below {folder}")
    try:
        content = file.read_bytes()
    except OSError as error:
        raise InputDataError(f"figure {link!r} in {folder}: {error.strerror}") from error
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _framed(tokens: Sequence[Token]) -> list[Token]:
    """Each table in a box that scrolls; a paragraph that is one image as a figure with its name below."""
    framed: list[Token] = []
    for i, token in enumerate(tokens):
        if token.type == "table_open":
            framed.append(Token("html_block", "", 0, content='<div class="table">\n'))
        if _is_image(tokens, i):
            token.type, token.tag = "figure_open", "figure"
        elif _is_image(tokens, i - 2):
            image = (tokens[i - 1].children or [])[0]
            caption = f"<figcaption>{escape(image.content.replace('_', ' '))}</figcaption>\n"
            framed.append(Token("html_block", "", 0, content=caption))
            token.type, token.tag = "figure_close", "figure"
        framed.append(token)
        if token.type == "table_close":
            framed.append(Token("html_block", "", 0, content="</div>\n"))
    return framed


def _is_image(tokens: Sequence[Token], i: int) -> bool:
    """Whether an image alone is what opens at ``i``."""
    if i < 0 or i + 1 >= len(tokens):
        return False
    children = tokens[i + 1].children or []
    return (
        tokens[i].type in ("paragraph_open", "figure_open")
        and len(children) == 1
        and children[0].type == "image"
    )
