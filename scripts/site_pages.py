"""Pages of the site from outside docs/: notebooks, pages of the project, and a reference of every public name.

A hook of mkdocs, see mkdocs.yml. It reads the public names from the packages themselves, so that none can be forgotten.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import posixpath
import re
from pathlib import Path
from types import ModuleType
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.plugins import event_priority
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

import exoid

ROOT = Path(__file__).parents[1]

PROJECT = ("BENCHMARKS.md", "CHANGELOG.md", "CONTRIBUTING.md")
"""Pages in the root of the repository."""

LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)")
"""A link in Markdown: its text and its target."""

LINK_IN_HTML = re.compile(r'href="(?!\w+:)([^"#]+\.(?:md|ipynb))(#[^"]*)?"')
"""A link in HTML to a source of a page: the file, and the place in it."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Add the pages of the reference to the navigation."""
    assert config.nav is not None
    reference: Any = next(part["Reference"] for part in config.nav if "Reference" in part)
    reference.append({"Command line": "reference/command-line.md"})
    reference.extend({name: f"reference/{name}.md"} for name in public_packages())
    return config


@event_priority(100)  # before mkdocs-jupyter turns notebooks into pages
def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that no file in docs/ holds."""
    for path in (*(ROOT / name for name in PROJECT), *sorted((ROOT / "notebooks").glob("*.ipynb"))):
        name = path.relative_to(ROOT).as_posix()
        files.append(File(name, str(ROOT), config.site_dir, config.use_directory_urls))
    packages = public_packages()
    pages = reference_pages(packages)
    pages |= {"index": reference_index(packages), "command-line": command_line()}
    for name, text in pages.items():
        files.append(File.generated(config, f"reference/{name}.md", content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links between the folders of the repository into links between pages of the site."""

    def to_page(found: re.Match[str]) -> str:
        text, target = found.groups()
        path, mark, place = target.partition("#")
        if "://" in path or not path:
            return found[0]
        inside = path.removeprefix("../").removeprefix("docs/")
        if page.file.src_uri.startswith("reference/"):
            return found[0]
        here = "" if page.file.src_uri.count("/") == 0 else "../"
        if files.get_file_from_path(inside) is None:
            return text  # a file of the repository that is no page
        text = posixpath.basename(text).removesuffix(".md").replace("-", " ") if text.endswith(".md") else text
        return f"[{text}]({here}{inside}{mark}{place})"

    return LINK.sub(to_page, markdown)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links of notebooks into links between pages of the site: they are HTML before links are checked.

    Raises:
        FileNotFoundError: A link leads nowhere.
    """
    if not page.file.src_uri.endswith(".ipynb"):
        return html

    def to_page(found: re.Match[str]) -> str:
        path, place = found[1], found[2] or ""
        inside = posixpath.normpath(posixpath.join(posixpath.dirname(page.file.src_uri), path)).removeprefix("docs/")
        target = files.get_file_from_path(inside)
        if target is None:
            raise FileNotFoundError(f"{page.file.src_uri} links to {path}")
        return f'href="{target.url_relative_to(page.file)}{place}"'

    return LINK_IN_HTML.sub(to_page, html)


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """Let the search run without a network: by our script in place of one that the theme loads from elsewhere."""
    root = "../" * page.file.src_uri.count("/")
    return named(output.replace("https://unpkg.com/iframe-worker/shim", f"{root}javascripts/local-worker.js"))


def on_post_template(output: str, template_name: str, config: MkDocsConfig) -> str:
    """Do the same for the page that says that there is no such page."""
    return named(output) if template_name.endswith(".html") else output


def named(output: str) -> str:
    """Name what the theme leaves without a name for those who hear a page: search, navigation, empty headers.

    Args:
        output: The page in HTML.

    Returns:
        The page with names.
    """
    output = output.replace('role="dialog"', 'role="dialog" aria-label="Search"')
    output = re.sub(r'aria-labelledby="(__nav_\d[\d_]*)_label"', r'aria-labelledby="\1_title"', output)
    output = re.sub(r'class="md-nav__title" for="(__nav_\d[\d_]*)"', r'id="\1_title" \g<0>', output)
    return re.sub(r"<th( [^>]*)?></th>", r"<td\1></td>", output)


def public_packages() -> dict[str, ModuleType]:
    """Find all modules with public names.

    Returns:
        Modules by their dotted names, ``exoid`` first: packages that list ``__all__``, and modules among public names.
    """
    found = {"exoid": exoid}
    for name in sorted(exoid.__all__):
        if isinstance(getattr(exoid, name), ModuleType):
            module = getattr(exoid, name)
            found[module.__name__] = module
            for inner in pkgutil.iter_modules(getattr(module, "__path__", ())):
                if inner.ispkg and not inner.name.startswith("_"):
                    sub = importlib.import_module(f"{module.__name__}.{inner.name}")
                    if getattr(sub, "__all__", ()):
                        found[sub.__name__] = sub
    return found


def reference_pages(packages: dict[str, ModuleType]) -> dict[str, str]:
    """Write the page of each module: its public names, each described on the first page that has it.

    Args:
        packages: Modules by name.

    Returns:
        Pages in Markdown by the name of the module.
    """
    pages: dict[str, str] = {}
    described: dict[str, str] = {}
    for module_name, module in packages.items():
        names = [each for each in public_names(module) if not isinstance(getattr(module, each), ModuleType)]
        sources = {name: source_of(module, name) for name in names}
        elsewhere = [
            f"* [`{name}`]({described[source]}.md#{source})" for name, source in sources.items() if source in described
        ]
        new = {source: module_name for source in sources.values() if source not in described}
        described |= new
        parts = [f"# {module_name}", inspect.cleandoc(module.__doc__ or "").split("\n\n")[0]]
        parts += ["Described elsewhere:\n\n" + "\n".join(elsewhere)] if elsewhere else []
        parts += [f"::: {source}" for source in new]
        pages[module_name] = "\n\n".join(parts) + "\n"
    return pages


def public_names(module: ModuleType) -> list[str]:
    """List the public names of a module: ``__all__``, else what it defines itself.

    Args:
        module: The module.

    Returns:
        Names in alphabetical order.
    """
    listed = getattr(module, "__all__", None)
    if listed is None:
        own = (key for key, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__)
        listed = [key for key in own if not key.startswith("_")]
    return sorted(listed, key=str.lower)


def source_of(module: ModuleType, name: str) -> str:
    """Find where a public name is defined, which is where its documentation is read.

    Args:
        module: Module that exports the name.
        name: The name.

    Returns:
        Dotted path.
    """
    value = getattr(module, name)
    home = getattr(value, "__module__", None)
    if isinstance(home, str) and home.startswith("exoid") and getattr(value, "__qualname__", "") == name:
        return f"{home}.{name}"
    return f"{module.__name__}.{name}"


def reference_index(packages: dict[str, ModuleType]) -> str:
    """Write the first page of the reference: the names that most users need, then every module with its subject.

    Args:
        packages: Modules by name.

    Returns:
        The page in Markdown.
    """
    rows = [
        f"| [`{name}`]({name}.md) | {(module.__doc__ or '').splitlines()[0]} |" for name, module in packages.items()
    ]
    exoid = packages["exoid"]
    inner = {name: getattr(exoid, name) for name in public_names(exoid)}
    first = [
        f"| [`exoid.{name}`](exoid.md#{source_of(exoid, name)}) | {re.sub(r':[a-z]+:`', '`', text.splitlines()[0])} |"
        for name, each in inner.items()
        if not isinstance(each, ModuleType) and (text := inspect.getdoc(each))
    ]
    head = "# Reference\n\nArrays are (N, n), samples first and joints second; units are SI.\n"
    ring = ["## All you need\n", "These names take you from a URDF and logs to a model and its use.\n"]
    more = ["\n## Advanced\n", "Every public name, by module.\n"]
    return "\n".join([head, *ring, *_table("name", first), *more, *_table("module", rows)]) + "\n"


def _table(of_what: str, rows: list[str]) -> list[str]:
    """Put a head above rows of names and subjects."""
    return [f"| {of_what} | subject |", "|---|---|", *rows]


def command_line() -> str:
    """Write the page of the command: every verb with its arguments and options.

    Returns:
        The page in Markdown.
    """
    import typer  # noqa: PLC0415 - only the command needs it
    from typer.cli import get_docs_for_click  # noqa: PLC0415

    from exoid.cli.app import app  # noqa: PLC0415

    command = typer.main.get_command(app)
    context = typer.Context(command, info_name="exoid")
    return get_docs_for_click(obj=command, ctx=context, name="exoid", title="Command line")
