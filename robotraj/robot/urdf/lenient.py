"""XML as other readers of URDFs accept it: what is not well-formed there but unambiguous is repaired.

Prefixes without a declaration, comments with ``--``, text before the declaration, other encodings, bare ampersands and
a second top element are common in URDFs, since the readers of Pinocchio and MuJoCo accept them. Names keep their
prefixes, and no namespaces are resolved.
"""

from __future__ import annotations

import codecs
import re
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

AMPERSAND = re.compile(r"&(?!#?\w{1,40};)")
ENCODING = re.compile(rb"<\?xml\b[^>]*encoding\s*=\s*[\"']([A-Za-z0-9._-]+)[\"']")
HEAD = 1_000
"""Bytes at the beginning of a file in which its encoding is declared."""
DEEPEST = 200
"""Largest depth of elements; functions that call themselves for each child have room for it."""
XACRO = "xacro:"
DEFINITIONS = tuple(XACRO + each for each in ("property", "arg", "macro"))
"""Elements of xacro that have no effect where nothing uses them."""
STATEMENTS = {XACRO + each for each in ("attribute", "call", "element", "if", "include", "insert_block", "unless")}
"""Elements that xacro replaces; others call macros."""


def parsed(data: bytes) -> Element:
    """Return the root element of a file.

    Raises
    ------
    ValueError
        The file is no XML; the message states the line.
    """
    text = AMPERSAND.sub("&amp;", _without_declaration(_without_comments(decoded(data))))
    builder, parser = TreeBuilder(), expat.ParserCreate()

    depth = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > DEEPEST:
            raise ValueError(f"more than {DEEPEST} elements lie in each other")
        builder.start(tag, {key: value for key, value in attributes.items() if key.partition(":")[0] != "xmlns"})

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.buffer_text = True
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        if error.code != expat.errors.codes[expat.errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT]:
            raise ValueError(str(error)) from error
    return builder.close()


def decoded(data: bytes) -> str:
    """Return the text of a file: in the encoding of its mark, in UTF-8, in the declared one, or in Latin-1."""
    marks = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
    tried = [name for mark, name in marks if data.startswith(mark)] + ["utf-8"]
    declared = ENCODING.search(data[:HEAD])
    if declared:
        tried.append(declared.group(1).decode())
    for name in tried:
        try:
            return data.decode(name)
        except (LookupError, UnicodeError):
            continue
    return data.decode("latin-1")


def without_definitions(root: Element, source: bool = False) -> bool:
    """Remove definitions of xacro that nothing uses; return whether the file still needs xacro.

    Calls of macros that a URDF neither defines nor includes stay in it: old versions of xacro left them in what they
    made, and other readers ignore them. The ``source`` of a URDF, a file of xacro, is not read without its macros.
    """
    macros = set()
    for child in list(root):
        if child.tag in DEFINITIONS:
            root.remove(child)
            macros.add(XACRO + child.get("name", "").removeprefix(XACRO))
    found = set(calls(root))
    return (
        bool(found & (macros | STATEMENTS)) or (source and bool(found)) or any(_computes(each) for each in root.iter())
    )


def _computes(element: Element) -> bool:
    """Whether the attributes of an element are expressions of xacro."""
    return not element.tag.startswith(XACRO) and any("${" in each or "$(" in each for each in element.attrib.values())


def calls(root: Element) -> tuple[str, ...]:
    """Return the elements of xacro in a file, by name."""
    return tuple(dict.fromkeys(each.tag for each in root.iter() if each.tag.startswith(XACRO)))


def _without_comments(text: str) -> str:
    """Leave out comments but for their line breaks, so that messages state the lines of the file."""
    kept, at = [], 0
    while (begin := text.find("<!--", at)) >= 0 and (end := text.find("-->", begin + 4)) >= 0:
        kept += [text[at:begin], "\n" * text.count("\n", begin, end)]
        at = end + 3
    return "".join([*kept, text[at:]])


def _without_declaration(text: str) -> str:
    """Leave out the declaration of XML, which may follow blank lines; its encoding has been read."""
    start = text.lstrip("\ufeff \t\r\n")
    end = start.find("?>") if start.startswith("<?xml") else -1
    return text[: len(text) - len(start)].strip("\ufeff") + (start[end + 2 :] if end >= 0 else start)
