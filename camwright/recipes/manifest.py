"""manifest.json: the checksum of every file of a recipe folder, and its own."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from camwright.recipes.model import Origin
from camwright.recipes.recipe_file import canonical

MANIFEST_FILE = "manifest.json"

_KIND = "camwright recipe manifest"


def sha256(data: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


def manifest_text(files: Mapping[str, bytes], origin: Origin) -> str:
    """Write the manifest of files, by their paths in the folder.

    Its own ``sha256`` is that of the same text without that line's entry, so that a change in the manifest is found, too.
    """
    entries = [{"path": path, "sha256": sha256(files[path]), "bytes": len(files[path])} for path in sorted(files)]
    content = {"kind": _KIND, "schema_version": 1, "provenance": asdict(origin), "files": entries}
    return canonical({**content, "sha256": own_sum(content)})


def own_sum(content: Mapping[str, Any]) -> str:
    """Checksum of a manifest's content without its own checksum."""
    return sha256(canonical({key: value for key, value in content.items() if key != "sha256"}).encode())


def read_manifest(data: bytes) -> tuple[dict[str, tuple[str, int]], list[str]]:
    """Read a manifest.

    Parameters
    ----------
    data
        Bytes of the file.

    Returns
    -------
    (files, faults)
        Checksum and size by path, as far as they can be read; what is wrong with the manifest itself.
    """
    try:
        content = json.loads(data.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        return {}, [f"not JSON in UTF-8: {error}"]
    if not isinstance(content, dict):
        return {}, ["not an object"]
    faults = []
    if content.get("kind") != _KIND or content.get("schema_version") != 1:
        faults.append(f"kind {content.get('kind')!r:.60} of version {content.get('schema_version')!r:.20} is not read")
    written = canonical_bytes(content)
    if written != data:
        faults.append("its bytes are not those that were written")
    found = own_sum(content) if written else "unknown"
    if content.get("sha256") != found:
        faults.append(f"sha256 is {content.get('sha256')!r:.80}, but that of its content is {found}")
    files: dict[str, tuple[str, int]] = {}
    for entry in content["files"] if isinstance(content.get("files"), list) else []:
        match entry:
            case {"path": str(path), "sha256": str(stored), "bytes": int(size)}:
                files[path] = (stored, size)
            case _:
                faults.append(f"entry {entry!r:.80} has no path, sha256 and bytes")
    if not files:
        faults.append("lists no files")
    return files, faults


def job_of_manifest(data: bytes) -> str:
    """SHA-256 of the job that a manifest, sound by `read_manifest`, is of; empty where it says none."""
    origin = json.loads(data).get("provenance")
    return str(origin.get("job_sha256", "")) if isinstance(origin, dict) else ""


def canonical_bytes(content: dict[str, Any]) -> bytes:
    """Bytes of a manifest as this program writes it; none if it holds what it never writes."""
    try:
        return canonical(content).encode()
    except ValueError:  # NaN, infinity, half a surrogate pair
        return b""
