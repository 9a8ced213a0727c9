"""Detached signatures of a recipe: Ed25519 over the bytes of its manifest, with keys as PEM files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from camwright.house.files import read_bytes
from camwright.profiles.errors import InputError

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

SIGNATURE_FILE = "manifest.json.sig"
"""The signature beside the manifest: 64 bytes, as ``openssl pkeyutl -rawin`` reads them."""

_MOST_BYTES = 2**16
_MAKE = "openssl genpkey -algorithm ed25519 -out key.pem"
_PUBLIC = "openssl pkey -in key.pem -pubout -out pub.pem"


def signed(data: bytes, key: Path) -> bytes:
    """Sign bytes; the same bytes and key give the same signature.

    Parameters
    ----------
    data
        What is signed.
    key
        PEM file of a private key.

    Raises
    ------
    InputError
        The file is no private Ed25519 key without a passphrase.
    """
    return _private(key).sign(data)


def is_signed(data: bytes, signature: bytes, key: Path) -> bool:
    """Whether a signature is of these bytes and the private half of a key.

    Parameters
    ----------
    data
        What was signed.
    key
        PEM file of the public key.

    Raises
    ------
    InputError
        The file is no public Ed25519 key.
    """
    from cryptography.exceptions import InvalidSignature

    public = _public(key)
    try:
        public.verify(signature, data)
    except InvalidSignature:
        return False
    return True


def require_private_key(key: Path) -> None:
    """Refuse a file that cannot sign, before the work that it would sign.

    Raises
    ------
    InputError
        As of `signed`.
    """
    _private(key)


def _private(key: Path) -> Ed25519PrivateKey:
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    data = read_bytes(key, "key file", _MOST_BYTES)
    if b"PUBLIC KEY" in data:
        raise InputError(f"{key}: a public key; --sign takes the private one, and --key of verify the public one")
    try:
        found = load_pem_private_key(data, password=None)
    except TypeError as error:
        raise InputError(
            f"{key}: this key has a passphrase, and camwright asks for none; write one without: openssl pkey -in {key.name} -out key.pem"
        ) from error
    except (ValueError, UnsupportedAlgorithm) as error:
        raise InputError(f"{key}: not a private key as PEM; make one: {_MAKE}") from error
    if not isinstance(found, Ed25519PrivateKey):
        raise InputError(f"{key}: not an Ed25519 key; make one: {_MAKE}")
    return found


def _public(key: Path) -> Ed25519PublicKey:
    from cryptography.exceptions import UnsupportedAlgorithm
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import load_pem_public_key

    data = read_bytes(key, "key file", _MOST_BYTES)
    if b"PRIVATE KEY" in data:
        raise InputError(f"{key}: a private key; keep it to yourself and give --key the public half: {_PUBLIC}")
    try:
        found = load_pem_public_key(data)
    except (ValueError, UnsupportedAlgorithm) as error:
        raise InputError(f"{key}: not a public key as PEM; the public half of a key: {_PUBLIC}") from error
    if not isinstance(found, Ed25519PublicKey):
        raise InputError(f"{key}: not an Ed25519 key; the public half of one: {_PUBLIC}")
    return found
