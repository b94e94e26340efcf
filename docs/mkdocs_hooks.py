"""Hooks of mkdocs.yml: what docs/ links to elsewhere in the repository becomes part of the site, by its path there."""

import os
import pathlib
import posixpath
import re
import sys
import urllib.parse

from mkdocs.structure.files import File

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import check  # noqa: E402

ROOT = str(check.ROOT)
NOT_OF_THE_SITE = re.compile(r".*\.py$|doxygen/|__pycache__/")


def slug(text, _):
    return check.slug(text)


def on_config(config):
    config["mdx_configs"].setdefault("toc", {})["slugify"] = slug  # anchors as in the repository
    return config


def target_of(page, link):
    """The path in the repository that a link of the page at this path means, and the link's anchor; None: no file."""
    name, _, anchor = link.partition("#")
    if not name or re.match(r"[a-z][a-z0-9+.-]*:", name):
        return None
    path = posixpath.normpath(posixpath.join(posixpath.dirname(page), urllib.parse.unquote(name)))
    return (path, anchor) if not path.startswith("..") and os.path.exists(os.path.join(ROOT, path)) else None


def site_path(path):
    """Where a file of the repository lies in the site: pages of docs/ at its top."""
    return "index.md" if path == "README.md" else path.removeprefix("docs/")


def on_files(files, config):
    for file in list(files):
        if NOT_OF_THE_SITE.match(file.src_uri):
            files.remove(file)
    known = {"README.md"} | {f"docs/{file.src_uri}" for file in files}
    waiting = [f"docs/{file.src_uri}" for file in files if file.src_uri.endswith(".md")]
    while waiting:
        page = waiting.pop()
        with open(os.path.join(ROOT, page), encoding="utf-8") as stream:
            found = [target_of(page, link) for _, link in check.links(stream.read())]
        for path, _ in filter(None, found):
            if path in known or path.startswith("docs/") or not os.path.isfile(os.path.join(ROOT, path)):
                continue
            known.add(path)
            files.append(File(path, ROOT, config["site_dir"], config["use_directory_urls"]))
            if path.endswith(".md"):
                waiting.append(path)
    return files


def on_page_markdown(markdown, page, config, files):
    path = os.path.relpath(page.file.abs_src_path, ROOT)

    def replaced(match):
        target = target_of(path, match[3])
        if target is None:
            return match[0]
        name = posixpath.basename(target[0])
        if os.path.isdir(os.path.join(ROOT, target[0])) or "." not in name or name.endswith(".py"):
            return match[2]  # mkdocs has nothing to go to
        link = posixpath.relpath(site_path(target[0]), posixpath.dirname(site_path(path)) or ".")
        return f"{match[1]}[{match[2]}]({link}{'#' + target[1] if target[1] else ''})"

    lines, fence = markdown.splitlines(), None
    for i, line in enumerate(lines):
        mark = re.match(r"\s*(`{3,}|~{3,})", line)
        if fence is None and mark:
            fence = mark[1]
        elif fence is not None:
            fence = None if line.strip() == fence else fence
        else:
            lines[i] = re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", replaced, line)
    return "\n".join(lines) + "\n"
