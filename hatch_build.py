"""README as the package index shows it: links into the repository, which lead nowhere there, become text."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

IMAGE = re.compile(r"^!\[[^\]]*\]\((?!https?://)[^)]*\)\n+", re.MULTILINE)
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https?://|#)([^)#]*)(?:#[^)]*)?\)")

NOTE = """> Pages, notebooks and tests that are named here, such as `docs/logs.md`, are in the source distribution:
> `pip download --no-deps --no-binary exoid exoid=={version}`.

"""

INSTALL = (
    (re.compile(r",? pip,? and a copy of this repository"), " and pip"),
    (re.compile(r"pip install \.(?=\s)"), "pip install exoid"),
    (re.compile(r"pip install '\.(?=\[view\])"), "pip install 'exoid"),
)
"""What a reader of the index does instead of what a reader of the repository does."""


def index_page(readme: str, version: str) -> str:
    """Rewrite the README for a page without the repository beside it.

    Args:
        readme: README in Markdown.
        version: Version that is built.

    Returns:
        README with absolute links only: a relative link becomes its text with the file in code, a relative image is
        left out.
    """
    for there, here in INSTALL:
        readme = there.sub(here, readme)
    title, _, rest = IMAGE.sub("", readme).partition("\n\n")
    return f"{title}\n\n{NOTE.format(version=version)}{LINK.sub(_plain, rest)}"


def _plain(link: re.Match[str]) -> str:
    """Text of a link, with its file unless the text names it."""
    text, file = " ".join(link[1].split()), link[2]
    return f"`{file}`" if text in (file, Path(file).name) else f"{text} (`{file}`)"


class ReadmeHook(MetadataHookInterface):
    """Hook of the build: it sets the dynamic field ``readme``."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set the readme.

        Args:
            metadata: Metadata of the project, which is changed.
        """
        readme = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        version = (Path(self.root) / "exoid" / "_version.py").read_text(encoding="utf-8").split('"')[-2]
        metadata["readme"] = {"content-type": "text/markdown", "text": index_page(readme, version)}
