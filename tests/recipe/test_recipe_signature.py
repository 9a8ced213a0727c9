"""Detached signatures: who wrote a recipe, proved by a key, and every key that is none."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from cryptography.hazmat.primitives.asymmetric.ec import SECP256R1, generate_private_key
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
from cryptography.hazmat.primitives.serialization import (
    BestAvailableEncryption,
    Encoding,
    NoEncryption,
    PrivateFormat,
    PublicFormat,
)

from camwright.cli.main import main
from camwright.profiles.errors import InputError
from camwright.recipes.build import MadeRecipe
from camwright.recipes.signature import SIGNATURE_FILE, is_signed, signed
from camwright.recipes.verify import examine
from camwright.recipes.write import recipe_files, write_folder

KEY = Ed25519PrivateKey.from_private_bytes(bytes(range(32)))


def private(path: Path, key: object = KEY, encryption: object = None) -> Path:
    path.write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, encryption or NoEncryption()))  # type: ignore[attr-defined]
    return path


def public(path: Path, key: object = KEY) -> Path:
    path.write_bytes(key.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo))  # type: ignore[attr-defined]
    return path


@pytest.fixture
def sealed(folder: Path, tmp_path: Path) -> Path:
    """Give a signed recipe, and beside it key.pem and pub.pem."""
    key = private(tmp_path / "key.pem")
    public(tmp_path / "pub.pem")
    (folder / SIGNATURE_FILE).write_bytes(signed((folder / "manifest.json").read_bytes(), key))
    return folder


def test_a_signed_recipe_is_proved_to_be_of_its_owner(sealed: Path, tmp_path: Path) -> None:
    found = examine(sealed, tmp_path / "pub.pem")
    assert found.faults == found.notes == ()
    assert found.proved[-1] == f"signed by the owner of {tmp_path / 'pub.pem'}"


def test_a_signature_that_nobody_asked_for_is_named(sealed: Path) -> None:
    found = examine(sealed)
    assert found.faults == ()
    assert found.notes[0].what == "signed, but the signature was not checked: name the public key with --key"
    assert found.proved[-1].startswith("not proved: who wrote it")


def test_another_recipe_another_key_and_no_signature_are_told(sealed: Path, saw: MadeRecipe, tmp_path: Path) -> None:
    key = tmp_path / "pub.pem"
    write_folder(recipe_files(saw), tmp_path / "saw")
    assert [fault.what for fault in examine(tmp_path / "saw", key).faults] == ["missing: this recipe is not signed"]
    shutil.copy(sealed / SIGNATURE_FILE, tmp_path / "saw")
    forged = f"not a signature of this manifest.json by the owner of {key}"
    assert [fault.what for fault in examine(tmp_path / "saw", key).faults] == [forged]
    other = public(tmp_path / "other.pem", Ed25519PrivateKey.from_private_bytes(bytes(32)))
    assert examine(sealed, other).faults
    for data in (b"", b"\x00" * 64, b"\x00" * 65):
        (sealed / SIGNATURE_FILE).write_bytes(data)
        assert [fault.what for fault in examine(sealed, key).faults] == [forged]


def test_no_changed_bit_of_a_signature_passes(tmp_path: Path) -> None:
    key, pub, data = private(tmp_path / "key.pem"), public(tmp_path / "pub.pem"), b"manifest"
    signature = signed(data, key)
    assert is_signed(data, signature, pub)
    for at in range(len(signature)):
        changed = signature[:at] + bytes([signature[at] ^ (1 << at % 8)]) + signature[at + 1 :]
        assert not is_signed(data, changed, pub)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (public, "a public key; --sign takes the private one"),
        (lambda path: private(path, encryption=BestAvailableEncryption(b"secret")), "this key has a passphrase"),
        (lambda path: private(path, generate_private_key(SECP256R1())), "not an Ed25519 key; make one: openssl genpkey"),
        (lambda path: path.write_text("-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n"), "not a private key as PEM"),
        (lambda path: path.write_text("ssh-ed25519 AAAA"), "not a private key as PEM"),
        (lambda path: path.write_bytes(b""), "the key file is empty"),
        (lambda path: path, "there is no such key file"),
    ],
)  # fmt: skip
def test_what_cannot_sign_is_refused(make: Callable[[Path], object], said: str, tmp_path: Path) -> None:
    make(tmp_path / "key.pem")
    with pytest.raises(InputError, match=said):
        signed(b"", tmp_path / "key.pem")


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (private, "a private key; keep it to yourself"),
        (lambda path: public(path, generate_private_key(SECP256R1())), "not an Ed25519 key"),
        (lambda path: path.write_text("-----BEGIN PUBLIC KEY-----\nAAAA\n-----END PUBLIC KEY-----\n"), "not a public key as PEM"),
        (lambda path: path, "there is no such key file"),
    ],
)  # fmt: skip
def test_what_cannot_prove_is_refused(make: Callable[[Path], object], said: str, tmp_path: Path) -> None:
    make(tmp_path / "pub.pem")
    with pytest.raises(InputError, match=said):
        is_signed(b"", b"\x00" * 64, tmp_path / "pub.pem")


def test_the_commands(paper_job: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    key, pub, out = private(tmp_path / "key.pem"), public(tmp_path / "pub.pem"), tmp_path / "recipe"
    asked = ["recipe", str(paper_job), "--targets", "csv", "--out", str(out)]
    assert main([*asked, "--sign", str(pub)]) == 2
    assert not out.exists()
    assert main([*asked, "--sign", str(key), "--quiet"]) == 0
    first = (out / SIGNATURE_FILE).read_bytes()
    assert main(["verify", str(out), "--key", str(pub)]) == 0
    assert f"signed by the owner of {pub}" in capsys.readouterr().out.replace("\n", " ")
    openssl = shutil.which("openssl")
    if openssl is not None:
        given = ["-inkey", pub, "-rawin", "-in", out / "manifest.json", "-sigfile", out / SIGNATURE_FILE]
        subprocess.run([openssl, "pkeyutl", "-verify", "-pubin", *given], check=True, capture_output=True)
    assert main([*asked, "--sign", str(key), "--quiet"]) == 0
    assert (out / SIGNATURE_FILE).read_bytes() == first  # same recipe and key, same bytes
    assert main([*asked, "--quiet"]) == 0
    assert not (out / SIGNATURE_FILE).exists()
    assert main(["verify", str(out), "--key", str(pub), "--quiet"]) == 1
    assert main(["recipe", "--compare", str(out), str(out), "--sign", str(key)]) == 2
