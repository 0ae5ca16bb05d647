"""The software bill of materials of a wheel, as CycloneDX 1.6 in JSON: the same dependencies give the same bytes."""

from __future__ import annotations

import json
import re
import uuid
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from release.licences import normal

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from release.licences import Dependency


def hashes(lock: str) -> dict[str, list[str]]:
    """Package → SHA-256 of each of its files, of a lock file's text."""
    found: dict[str, list[str]] = {}
    for row in re.split(r"\n(?=\S)", lock):
        match = re.match(r"([\w.-]+)==", row)
        if match is not None:
            found[normal(match[1])] = re.findall(r"--hash=sha256:([0-9a-f]{64})", row)
    return found


def sbom(
    version: str, wheel_sha256: str, rows: Iterable[Dependency], files: Mapping[str, list[str]], epoch: int
) -> str:
    """The bill of the wheel with this SHA-256. ``files``: package → hashes of the files that may be installed."""
    rows = [row for row in rows if row.version]
    own = _reference("simworlds", version)
    references = {row.name: _reference(row.name, row.version) for row in rows}
    direct = [references[row.name] for row in rows if row.direct]
    content: dict[str, Any] = {
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, f'simworlds:{version}:{wheel_sha256}')}",
        "version": 1,
        "metadata": {
            "timestamp": datetime.fromtimestamp(epoch, UTC).isoformat().replace("+00:00", "Z"),
            "component": {
                "type": "application",
                "bom-ref": own,
                "name": "simworlds",
                "version": version,
                "purl": own,
                "licenses": [{"expression": "GPL-3.0-or-later"}],
                "hashes": [{"alg": "SHA-256", "content": wheel_sha256}],
            },
        },
        "components": [_component(row, references[row.name], files.get(row.name, [])) for row in rows],
        "dependencies": [
            {"ref": own, "dependsOn": direct},
            *(
                {
                    "ref": references[row.name],
                    "dependsOn": [references[name] for name in row.requires if name in references],
                }
                for row in rows
            ),
        ],
    }
    return json.dumps(content, indent=2) + "\n"


def _reference(name: str, version: str) -> str:
    return f"pkg:pypi/{name}@{version}"


def _component(row: Dependency, reference: str, files: list[str]) -> dict[str, Any]:
    component: dict[str, Any] = {
        "type": "library",
        "bom-ref": reference,
        "name": row.name,
        "version": row.version,
        "purl": reference,
        "scope": "optional" if row.extras else "required",
        "licenses": [{"expression": row.licence}],
    }
    if files:  # one of these is installed, by the system and the Python
        component["properties"] = [{"name": "simworlds:sha256", "value": digest} for digest in files]
    return component
