"""Checks that each relative link and image of the tracked Markdown files leads to a tracked file or folder and, with an
anchor, to one of its headings."""
import os
import pathlib
import re
import subprocess
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(\s*<?([^()\s<>]+)>?(?:\s+\"[^\"]*\")?\s*\)|^\s*\[[^\]]+\]:\s*(\S+)|"
                  r"\b(?:src|href)=\"([^\"]+)\"", re.MULTILINE)
CODE = re.compile(r"^ *(```+|~~~+).*?^ *\1|(?<!`)(`+)(?!`).*?(?<!`)\2(?!`)", re.MULTILINE | re.DOTALL)


def blank(match):
    """The same number of lines without text."""
    return re.sub(r"[^\n]", " ", match[0])


def anchors(path):
    """The anchors of a page's headings, by GitHub's rule."""
    text = re.sub(r"(?ms)^ *(```+|~~~+).*?^ *\1", blank, path.read_text(encoding="utf-8"))
    found = {}
    for heading in re.findall(r"(?m)^#{1,6} +(.*?)(?: +#+)? *$", text):
        heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)  # a link's text
        anchor = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        count = found.get(anchor, -1) + 1
        found[anchor] = count
        if count:
            found[f"{anchor}-{count}"] = 0
    for name in re.findall(r"<[^>]+\b(?:id|name)=\"([^\"]+)\"", text):
        found[name] = 0
    return found


def check(page, files, folders):
    """Returns a line for each link of a page that leads nowhere, and the number of links."""
    text = CODE.sub(blank, (ROOT / page).read_text(encoding="utf-8"))
    problems, number = [], 0
    for match in LINK.finditer(text):
        target = next(group for group in match.groups() if group)
        url = urllib.parse.urlsplit(target)
        if url.scheme or url.netloc:
            continue
        number += 1
        place = f"{page}:{text.count(chr(10), 0, match.start()) + 1}"
        name = os.path.normpath(os.path.join(os.path.dirname(page), urllib.parse.unquote(url.path))) if url.path else page
        if name not in files and name not in folders:
            problems.append(f"{place}: git tracks no file or folder '{target}'")
        elif url.fragment and name.endswith(".md") and urllib.parse.unquote(url.fragment) not in anchors(ROOT / name):
            problems.append(f"{place}: {name} has no heading '#{url.fragment}'")
    return problems, number


def main():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0")
    files = {name for name in listed if name and (ROOT / name).exists()}
    folders = {str(parent) for name in files for parent in pathlib.PurePosixPath(name).parents}
    pages = sorted(name for name in files if name.endswith(".md"))
    problems, number = [], 0
    for page in pages:
        found, links = check(page, files, folders)
        problems += found
        number += links
    print(f"{number} links of {len(pages)} pages")
    if number < len(pages):
        problems.append("fewer links than pages: are they still found?")
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    main()
